/* What the static libraries of the sundials4py wheel miss.
 *
 * They were built for the Python bindings of SUNDIALS. On destroying an object they call a
 * function of the bindings that releases the Python callbacks stored with that object. Here
 * nothing is stored, so there is nothing to release.
 *
 * No header declares these functions; all take the stored table, a null pointer here. Another
 * SUNDIALS has no such calls, and this file is then not compiled: see cmake/sundials.cmake.
 */
#define RELEASES_NOTHING(hook) \
  void hook(void* callbacks) { (void)callbacks; }

RELEASES_NOTHING(SUNContextFunctionTable_Destroy)
RELEASES_NOTHING(SUNDomEigEstimatorFunctionTable_Destroy)
RELEASES_NOTHING(SUNLinearSolverFunctionTable_Destroy)
RELEASES_NOTHING(SUNLoggerFunctionTable_Destroy)
RELEASES_NOTHING(SUNNonlinearSolverFunctionTable_Destroy)
RELEASES_NOTHING(SUNStepperFunctionTable_Destroy)

RELEASES_NOTHING(arkode_user_supplied_fn_table_destroy)
RELEASES_NOTHING(cvode_user_supplied_fn_table_destroy)
RELEASES_NOTHING(mristepinnerstepper_user_supplied_fn_table_destroy)
