#include "importer.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

Functions fmi;
Fmu fmu, another;

// --- tests --------------------------------------------------------------------------------------

enum { MOST_TESTS = 100 };

static struct {
  const char* name;
  Body body;
} tests[MOST_TESTS];
static int n_tests, n_failures;

void add_test(const char* name, Body body) {
  tests[n_tests].name = name;
  tests[n_tests++].body = body;
}

void fail(const char* file, int line, const char* format, ...) {
  ++n_failures;
  printf("%s:%d: not true: ", file, line);
  va_list values;
  va_start(values, format);
  vprintf(format, values);
  va_end(values);
  printf("\n");
}

// --- the FMU ------------------------------------------------------------------------------------

static const char* missing;  // the first function that is

static void* resolve(void* library, const char* name) {
  void* function = dlsym(library, name);
  if (function == NULL && missing == NULL) missing = name;
  return function;
}

static void load(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) {
    fprintf(stderr, "%s\n", dlerror());
    exit(2);
  }
  // A pointer to data is one to a function here, which C does not say but POSIX does.
#define RESOLVE(name) *(void**)&fmi.name = resolve(library, #name);
  FMI2_FUNCTIONS(RESOLVE)
  FMI3_FUNCTIONS(RESOLVE)
#undef RESOLVE
}

// The folder has resources/ and variables.txt: version, token and sampling time, and a line for
// each variable with its name, value reference, size and type.
static void read_fmu(Fmu* into, const char* folder) {
  char path[600];
  snprintf(into->resources, sizeof into->resources, "%s/resources", folder);
  snprintf(path, sizeof path, "%s/variables.txt", folder);
  FILE* file = fopen(path, "r");
  if (file == NULL ||
      fscanf(file, "%d %99s %lf", &into->version, into->token, &into->sampling_time) != 3) {
    fprintf(stderr, "%s: expected version, token and sampling time\n", path);
    exit(2);
  }
  Variable read;
  char type[20];
  while (fscanf(file, "%63s %u %zu %19s", read.name, &read.first, &read.size, type) == 4) {
    read.is_integer = strcmp(type, "integer") == 0;
    into->variables[into->n_variables++] = read;
    if (strncmp(read.name, "state.", 6) == 0) into->n_states += read.size;
    if (strncmp(read.name, "indicator.", 10) == 0) into->n_indicators += read.size;
  }
  fclose(file);
}

const Variable* find(const char* name) {
  for (size_t k = 0; k < fmu.n_variables; ++k) {
    if (strcmp(fmu.variables[k].name, name) == 0) return &fmu.variables[k];
  }
  return NULL;
}

// --- instances ----------------------------------------------------------------------------------

const Calls* calls(void) { return fmu.version == 2 ? &fmi2_calls : &fmi3_calls; }

void take_message(Instance* instance, Status status, const char* category, const char* message) {
  ++instance->n_messages;
  instance->latest = status;
  snprintf(instance->category, sizeof instance->category, "%s", category);
  snprintf(instance->message, sizeof instance->message, "%s", message);
}

void create(Instance* instance, Kind kind) {
  const fmi3IntermediateUpdateCallback intermediate_update = instance->intermediate_update;
  void* const of_test = instance->of_test;
  *instance =
      (Instance){.kind = kind, .intermediate_update = intermediate_update, .of_test = of_test};
  calls()->instantiate(instance, "arm", fmu.token, fmu.resources);
  if (instance->handle == NULL) {
    printf("no instance: %s\n", instance->message);
    exit(1);
  }
}

void destroy(Instance* instance) {
  calls()->free(instance->handle);
  instance->handle = NULL;
}

void begin(Instance* instance, Kind kind) {
  create(instance, kind);
  OK(calls()->enter_initialisation(instance->handle, 1e-7, 0.0, 10.0));
  OK(calls()->exit_initialisation(instance->handle));
}

Bytes bytes_of(Instance* instance, void* state) {
  Bytes bytes = {0};
  OK(calls()->size_of_state(instance->handle, state, &bytes.size));
  bytes.bytes = malloc(bytes.size);
  OK(calls()->serialise(instance->handle, state, bytes.bytes, bytes.size));
  return bytes;
}

Bytes state_of(Instance* instance) {
  void* state = NULL;
  OK(calls()->get_state(instance->handle, &state));
  const Bytes bytes = bytes_of(instance, state);
  OK(calls()->free_state(instance->handle, &state));
  CHECK(state == NULL);
  return bytes;
}

bool same_bytes(Bytes a, Bytes b) {
  return a.size == b.size && memcmp(a.bytes, b.bytes, a.size) == 0;
}

void check_refused(const char* what, Instance* instance, Status status, int messages_before) {
  CHECK_THAT(status == STATUS_ERROR, "%s is an error; status %d", what, status);
  CHECK_THAT(instance->n_messages == messages_before + 1, "%s has a message; %d", what,
             instance->n_messages - messages_before);
  CHECK_THAT(instance->latest == STATUS_ERROR && strcmp(instance->category, "logStatusError") == 0,
             "%s has a message about an error: %s", what, instance->message);
}

// Runs one test: importer LIBRARY FOLDER ANOTHER_FOLDER TEST.
int main(int argc, char** argv) {
  if (argc != 5) return 2;
  load(argv[1]);
  read_fmu(&fmu, argv[2]);
  read_fmu(&another, argv[3]);
  for (int k = 0; k < n_tests; ++k) {
    if (strcmp(tests[k].name, argv[4]) != 0) continue;
    tests[k].body();
    return n_failures > 0;
  }
  printf("no such test\n");
  return 2;
}

TEST(EveryFunctionOfTheStandardIsThere) {
  CHECK_THAT(missing == NULL, "%s is there", missing != NULL ? missing : "all");
}
