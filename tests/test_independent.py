"""The independent implementation itself: balances, closed forms, identities between its options."""

import numpy as np
import pytest
from independent import (
    TABLE_1,
    Hold,
    Hybrid,
    IndependentRobot,
    Quintic,
    Steps,
    cross,
    replaced,
    simulate,
)
from scipy.optimize import brentq

LOAD = (7.0, (0.06, -0.05, 0.18))
FULL, SIMPLIFIED = "full", "simplified"
MIXED = ("full", "full", "simplified", "full", "simplified", "full")
PUSH = (120.0, -80.0, 200.0)  # N
TABLES = {
    "table_1": {"p": (-90.0, 200.0, 70.0, -99.0, 80.0, -90.0), "b": (5.0,) * 6},
    "table_2": {"b": (0.02, 0.0, 0.01), "c": (30.0, 20.0, 40.0), "d": (0.02, 0.03, 0.05)},
    "table_3": {
        "arms": {2: {"mass": 40.0, "I13": -0.2}, 5: {"I33": 0.02}},
        "rJ": (2e-3, 1e-3, 3e-3, 2e-4, 1e-4, 6e-5),
        "rn": ("z", "x", "z", "x", "z", "x"),
        "gravity": 1.62,
    },
}


def any_state(robot, seed, resting=0.0):
    """A state in which each axis moves, or rests with a given chance, and no gear is slack."""
    rng = np.random.default_rng(seed)
    n, e = robot.n_axes, robot.n_elastic
    q = rng.uniform(-1.5, 1.5, n)
    qd, rotor_rate = rng.normal(0.0, 1.5, n), rng.normal(0.0, 80.0, n)
    rests = rng.random(n) < resting
    rotor_rate[rests] = 0.0
    qd[e:][rests[e:]] = 0.0
    return robot.state_from(
        q,
        qd,
        rotor_angle=robot.ratio * q + rng.normal(0.0, 0.1, n),
        rotor_rate=rotor_rate,
        motor_torque=rng.normal(0.0, 2.0, n),
    )


def energy(robot, z):
    angle, rate = z["rotor_angle"], z["rotor_rate"]
    q, qd = z["joint_angle"], z["joint_rate"]
    kinetic = robot.kinetic_energy(q, qd, rate)
    return kinetic + robot.potential_energy(q) + robot.elastic_energy(q, angle)


# --- power ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "options"),
    [
        (1, {}),
        (1, {"rotor_coupling": MIXED}),
        (2, {"arm": "six-arm"}),
        (2, {"rotor_coupling": SIMPLIFIED, "table_3": TABLES["table_3"]}),
        (3, {}),
        (3, {"rotor_coupling": FULL}),
        (3, {"rotor_coupling": MIXED, "gear_damping": "contact"}),
        (3, {"rotor_coupling": FULL, **TABLES}),
        (4, {"rotor_coupling": FULL, "arm": "six-arm", **TABLES}),
        (4, {"gear_damping": "contact"}),
    ],
)
@pytest.mark.parametrize("push", [None, PUSH], ids=["free", "pushed"])
def test_energy_changes_by_the_power_of_motors_friction_dampers_and_pushes(model, options, push):
    robot = IndependentRobot(model, *LOAD, **options)
    for seed in range(10):
        x = any_state(robot, seed, resting=0.3)
        system = Hybrid(robot, Hold(np.zeros(6)), tip_force=push)
        system.start(x)
        now, change, step = system.signals(0.0, x), system.derivatives(0.0, x), 1e-6
        z = system.split(x)

        power = (now["motor_torque"] - now["friction_torque"]) @ now["rotor_rate"]
        power -= robot.damping_power(
            now["joint_angle"], now["joint_rate"], z["rotor_angle"], z["rotor_rate"]
        )
        if push is not None:
            power += push @ robot.load_jacobian(now["joint_angle"]) @ now["joint_rate"]
        ahead, behind = (energy(robot, system.split(x + h * change)) for h in (step, -step))
        gained = (ahead - behind) / (2.0 * step)
        # Of kilojoules the difference quotient loses ten of sixteen digits; powers are kilowatts.
        assert gained == pytest.approx(power, rel=0, abs=3e-6)


def test_a_load_weighs_as_much_as_a_force_on_the_tip():
    mass, place = LOAD
    rest = np.zeros(6)
    loaded, empty = IndependentRobot(1, mass, place), IndependentRobot(1, 0.0, place)
    for seed in range(5):
        q = np.random.default_rng(seed).uniform(-2.0, 2.0, 6)
        weight = empty.load_jacobian(q).T @ [0.0, 0.0, -mass * 9.81]
        gained = loaded.bias(q, rest) - empty.bias(q, rest)
        assert gained == pytest.approx(-weight, abs=1e-12)  # roundoff of hundreds of N m


# --- coupling of rotors ---------------------------------------------------------------------------


def test_elastic_rotors_couple_by_the_terms_of_the_equations_of_motion():
    # Other rotor axes than those of Table 3, with which the gyroscopic terms cancel.
    robot = IndependentRobot(3, *LOAD, rotor_coupling=FULL, table_3=TABLES["table_3"])
    for seed in range(5):
        z = Hybrid(robot).split(any_state(robot, seed))
        q, qd, rotor_rate = z["joint_angle"], z["joint_rate"], z["rotor_rate"]
        turn, _, an = robot._poses(q)
        w, dw = np.zeros(3), np.zeros(3)  # of the arm before joint j, and its rate at aq'' = 0
        mass, bias = robot._equations(q, qd, rotor_rate)
        gyroscopic = bias - robot._equations(q, qd, np.zeros(3))[1]
        expected = np.zeros(9)
        for j, inertia in enumerate(robot.rotor_inertia[:3]):
            rn = turn[j] @ robot.rotor_axis[j]
            assert mass[:j, 6 + j] == pytest.approx(inertia * an[:j] @ rn, abs=1e-15)  # arM
            np.testing.assert_array_equal(mass[j:6, 6 + j], 0.0)
            expected[:j] += inertia * rotor_rate[j] * an[:j] @ cross(w, rn)
            assert bias[6 + j] == pytest.approx(inertia * rn @ dw, abs=1e-15)
            dw = dw + qd[j] * cross(w, an[j])
            w = w + qd[j] * an[j]
        np.testing.assert_allclose(mass[6:, 6:], np.diag(robot.rotor_inertia[:3]), rtol=1e-15)
        # a difference of hundreds of N m
        assert gyroscopic == pytest.approx(expected, rel=0, abs=1e-12)
        assert np.abs(expected).max() > 0.01


def test_with_ideal_gears_full_coupling_of_elastic_rotors_is_that_of_rigid_ones():
    elastic, rigid = IndependentRobot(3, *LOAD, rotor_coupling=FULL), IndependentRobot(1, *LOAD)
    for seed in range(5):
        rng = np.random.default_rng(seed)
        q, qd = rng.uniform(-2.0, 2.0, 6), rng.normal(0.0, 3.0, 6)
        assert elastic.mass_matrix(q) == pytest.approx(rigid.mass_matrix(q), abs=1e-12)
        assert elastic.bias(q, qd) == pytest.approx(rigid.bias(q, qd), rel=0, abs=1e-10)


def accelerations(robot, seed):
    x = any_state(robot, seed)
    system = Hybrid(robot, Hold(np.zeros(6)))
    system.start(x)
    return system.signals(0.0, x)["joint_acceleration"]


def test_only_rotors_across_whose_axis_an_earlier_joint_turns_are_coupled():
    simplified, coupled_1_and_2, coupled_3 = (
        IndependentRobot(4, *LOAD, rotor_coupling=coupling)
        for coupling in (SIMPLIFIED, (FULL, FULL, SIMPLIFIED), (SIMPLIFIED, SIMPLIFIED, FULL))
    )
    for seed in range(5):
        expected = accelerations(simplified, seed)
        # roundoff of rotor angles of 300 rad on stiff gears
        assert accelerations(coupled_1_and_2, seed) == pytest.approx(expected, rel=1e-10)
        assert np.abs(accelerations(coupled_3, seed) - expected).max() > 1e-3


def test_a_sticking_coupled_rotor_balances_its_carrier():
    robot = IndependentRobot(3, *LOAD, rotor_coupling=FULL)
    sticking = 0
    for seed in range(10):
        x = any_state(robot, seed, resting=0.6)
        system = Hybrid(robot, Hold(np.zeros(6)))
        z = system.split(x)
        z["rotor_angle"][:] = robot.ratio[:3] * z["joint_angle"][:3]
        z["joint_rate"] *= 0.1
        z["pt2_torque"][:3] *= 0.1
        system.start(x)
        now = system.signals(0.0, x)
        d = system.split(system.derivatives(0.0, x))
        mass, bias = system._equations(z)
        for j in np.flatnonzero(system.friction[:3] == 0):
            assert d["rotor_rate"][j] == 0.0
            carried = mass[6 + j, :6] @ now["joint_acceleration"] + bias[6 + j]
            balance = now["motor_torque"][j] - system._gear_torque(z)[j] - carried
            assert now["friction_torque"][j] == pytest.approx(balance, abs=1e-12)
            assert abs(now["friction_torque"][j]) <= robot.sticking_limit[j]
            sticking += j > 0
    assert sticking >= 5


# --- parameters -----------------------------------------------------------------------------------


def test_lumped_and_six_arm_data_differ_by_what_the_specification_says():
    lumped, six_arm = (IndependentRobot(2, *LOAD, arm=arm) for arm in ("lumped", "six-arm"))
    rng, worst = np.random.default_rng(1), 0.0
    for _ in range(50):
        q, qd = rng.uniform(-3.0, 3.0, 3), rng.uniform(-3.0, 3.0, 3)
        tau = rng.uniform(-9.0, 9.0, 3) * lumped.ratio
        one, other = (robot.forward_dynamics(q, qd, tau) for robot in (lumped, six_arm))
        worst = max(worst, np.abs(one - other).max() / np.abs(one).max())
    assert 1e-4 < worst < 0.015


def test_entries_of_tables_are_replaced_by_name_and_axis():
    table = replaced(
        TABLE_1, {"a": {2: 0.05}, "K_V": 0.2, "T": 0.004, "b": (5.0, 6.0, 7.0, 8, 9, 9)}
    )
    np.testing.assert_array_equal(table["a"], [0.094, 0.05, 0.094, 0.022, 0.096, 0.044])
    np.testing.assert_array_equal(table["K_V"], 0.2)
    np.testing.assert_array_equal(table["b"], [5.0, 6.0, 7.0, 8.0, 9.0, 9.0])
    np.testing.assert_array_equal(table["K_D"], TABLE_1["K_D"])
    assert table["T"] == 0.004
    with pytest.raises(KeyError):
        replaced(TABLE_1, {"K_X": 1.0})


@pytest.mark.parametrize("start", ["rotor", "arm"])
@pytest.mark.parametrize("model", [1, 3])
def test_motors_hold_the_arms_at_rest(model, start):
    robot = IndependentRobot(model, *LOAD, **TABLES, rotor_coupling=FULL)
    pose = np.array([0.3, -0.5, 0.8, 0.4, -0.6, 0.2])
    x = robot.rest_state(Hold(pose), start)
    system = Hybrid(robot, Hold(pose))
    system.start(x)
    now = system.signals(0.0, x)
    assert now["joint_acceleration"] == pytest.approx(np.zeros(6), abs=1e-10)
    assert now["friction_torque"] == pytest.approx(np.zeros(6), abs=1e-12)
    on_reference = {"rotor": "rotor_angle", "arm": "joint_angle"}[start]
    expected = pose * (robot.ratio if start == "rotor" else 1.0)
    np.testing.assert_array_equal(now[on_reference], expected)


# --- events of options ----------------------------------------------------------------------------


def test_a_tooth_that_lands_may_set_its_sticking_rotor_sliding():
    # Upright, arm 1 turns freely through its gap of 0.01 rad; then the damper takes d p aq'.
    robot = IndependentRobot(4, gear_damping="contact", controller=None)
    start = robot.state_from(np.zeros(3), [-1.0, 0.0, 0.0], np.zeros(3), np.zeros(3))
    run = simulate(robot, None, 2e-4, times=[2e-4], start=start)
    landing, slip = run.events[:2]
    assert landing == (pytest.approx(0.01 / 105.0, rel=1e-12), 1, "backlash", 0, -1)
    assert slip == (landing[0], 1, "friction", 0, 1)
    gentle = robot.state_from(np.zeros(3), [-0.7, 0.0, 0.0], np.zeros(3), np.zeros(3))
    events = simulate(robot, None, 1.4e-4, times=[1e-4], start=gentle).events  # 0.37 < 0.4 N m
    assert [event[1:] for event in events] == [(1, "backlash", 0, -1)]


def test_motors_without_controllers_break_their_axes_away_at_the_sticking_limits():
    robot = IndependentRobot(3, controller=None)
    assert robot.n_states == 18
    run = simulate(
        robot,
        None,
        3e-3,
        times=[3e-3],
        motor_torque=lambda t: np.array([200.0, 0.0, -320.0, 120.0, 0.0, 0.0]) * t,
    )
    expected = [(0.4 / 200.0, 1, 1), (0.7 / 320.0, 3, -1), (0.27 / 120.0, 4, 1)]
    # Gravity acts on the arms as soon as one of them leaves its pose.
    got = [(t, axis, after) for t, axis, element, _, after in run.events if element == "friction"]
    assert [event[1:] for event in got] == [event[1:] for event in expected]
    assert [event[0] for event in got] == pytest.approx([event[0] for event in expected], abs=1e-6)
    np.testing.assert_array_equal(np.isnan(run.voltage), True)


def test_a_torque_that_jumps_sets_an_axis_sliding_at_once():
    robot = IndependentRobot(4, controller=None)
    torque = Steps((1e-3,), ((0.39, 0.0, 0.0), (0.41, 0.0, 0.0)))
    run = simulate(robot, None, 1.5e-3, times=[1e-3], motor_torque=torque)
    assert run.events == [(1e-3, 1, "friction", 0, 1)]


def test_the_voltage_rests_at_its_limit_until_its_own_equation_lets_it_go():
    limit, command, t_end = 10.0, 8.0, 2e-3
    robot = IndependentRobot(2, controller="external", voltage_limit=limit)
    steps = Steps((1e-3,), ((command, 0.0, 0.0), (-command, 0.0, 0.0)))
    times = np.linspace(0.0, t_end, 41)
    run = simulate(robot, None, t_end, times=times, command=steps)
    events = [event for event in run.events if event[2] == "voltage_limit"]
    assert [event[3:] for event in events] == [(0, 1), (1, 0), (0, -1)]

    # As long as no tachogenerator speaks U = K_S u_c (t + (T_0 - T_e) (1 - exp(-t / T_e))).
    def voltage(t):
        return 340.8 * command * (t + (9.95e-3 - 0.56e-3) * -np.expm1(-t / 0.56e-3))

    reached = brentq(lambda t: voltage(t) - limit, 1e-5, 1e-3)
    assert events[0][0] == pytest.approx(reached, rel=1e-4)
    assert events[1][0] == 1e-3

    limited = (times > events[0][0]) & (times < 1e-3)
    assert limited.sum() > 5
    np.testing.assert_array_equal(run.voltage[limited, 0], limit)
    assert np.abs(run.voltage).max() == limit
    # Meanwhile the integral tends to the limit with T_0.
    away = limit - run.state[:, robot.slices["controller"]][limited, 0]
    expected = away[0] * np.exp(-(times[limited] - times[limited][0]) / 9.95e-3)
    assert away == pytest.approx(expected, rel=1e-10)


def test_a_voltage_at_its_limit_does_not_chatter():
    # An outstretched arm with its load is slow: a resting integral would let U go after a
    # millisecond at its limit, and drive it back at once.
    robot = IndependentRobot(2, 15.0, controller="external", voltage_limit=4.0)
    pose, command = Hold([0.0, 1.5, 0.0]), np.array([0.8, 0.0, 0.0])
    run = simulate(robot, pose, 0.012, times=[0.012], command=command)
    assert [event[3:] for event in run.events if event[2] == "voltage_limit"] == [(0, 1)]


# --- the sampled controller -----------------------------------------------------------------------


def test_the_sampled_controller_tends_to_the_continuous_one():
    motion, error = Quintic([0.0] * 3, [0.1, 0.0, 0.0], 0.1), []
    expected = simulate(IndependentRobot(2), motion, 4e-3, times=[4e-3]).rotor_angle
    for period in (0.4e-3, 0.2e-3):
        robot = IndependentRobot(2, controller="sampled", table_1={"T": period})
        got = simulate(robot, motion, 4e-3, times=[4e-3]).rotor_angle
        error.append(np.abs(got - expected).max())
    # A hold delays by half a period: first order.
    assert error[0] / error[1] == pytest.approx(2.0, rel=0.1)


def test_the_sampled_controller_commands_what_it_read_at_the_start_and_after_each_period():
    period, table = np.arange(4) * 2e-3, {"T": 2e-3}
    motion = Quintic([0.0] * 3, [0.1, 0.0, 0.0], 0.02)
    sampled, external = (
        IndependentRobot(2, controller=kind, table_1=table) for kind in ("sampled", "external")
    )
    start = sampled.state_from([0.001, 0.0, 0.0])
    run = simulate(sampled, motion, 6e-3, times=period, start=start)
    read = 0.3 * (sampled.ratio * motion.angle(period) - run.rotor_angle)
    command = Steps(period[1:3], (read + 0.03 * sampled.ratio * motion.rate(period))[:3])
    again = simulate(external, motion, 6e-3, times=period, start=start, command=command)
    np.testing.assert_array_equal(again.state, run.state)
    assert again.events == run.events
