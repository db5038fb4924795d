"""Exported robots step by step, through FMPy: states, indicators, derivatives, wrong calls."""

from concurrent.futures import ThreadPoolExecutor
from ctypes import c_double, c_int, c_uint

import numpy as np
import pytest

import manutec_r3 as r3

fmpy = pytest.importorskip("fmpy", reason="FMPy is missing: pip install 'manutec-r3[test]'")

SIX = r3.Quintic([0.0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], 1.2)
MOVING = r3.Scenario("moving", r3.Robot(3, r3.Load(15.0)), SIX, 0.5)
SAMPLED = r3.Scenario("sampled", r3.Robot(3, controller="sampled"), SIX, 0.5)
FREE = r3.Scenario("free", r3.Robot(1, r3.Load(10.0), controller=None), None, 0.5)


class Importer:
    """An instance in FMI 3.0, with its variables by name and what it has told."""

    def __init__(self, path, kind, **more):
        self.description = fmpy.read_model_description(path)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages = []
        self.fmu = fmpy.instantiate_fmu(
            fmpy.extract(path),
            self.description,
            kind,
            debug_logging=True,
            logger=lambda _, status, category, text: self.messages.append(
                (category.decode(), text.decode())
            ),
            **more,
        )
        self.fmu.enterInitializationMode(tolerance=1e-8, startTime=0.0)

    def begin(self):
        self.fmu.exitInitializationMode()
        if hasattr(self.fmu, "enterContinuousTimeMode"):
            next_event = self.fmu.updateDiscreteStates()
            self.fmu.enterContinuousTimeMode()
            return next_event[-1]
        return None

    def size(self, name):
        return int(np.prod([d.start for d in self.variables[name].dimensions] or [1], dtype=int))

    def get(self, name):
        variable = self.variables[name]
        get = self.fmu.getInt32 if variable.type == "Int32" else self.fmu.getFloat64
        return np.array(get([variable.valueReference], self.size(name)))

    def set(self, name, values):
        self.fmu.setFloat64([self.variables[name].valueReference], np.atleast_1d(values).tolist())

    def _array(self, read, n):
        values = (c_double * n)()
        read(values, n)
        return np.array(values)

    @property
    def n_states(self):
        return self.fmu.getNumberOfContinuousStates()

    @property
    def states(self):
        return self._array(self.fmu.getContinuousStates, self.n_states)

    @states.setter
    def states(self, values):
        self.fmu.setContinuousStates((c_double * len(values))(*values), len(values))

    @property
    def derivatives(self):
        return self._array(self.fmu.getContinuousStateDerivatives, self.n_states)

    @property
    def indicators(self):
        n = self.fmu.getNumberOfEventIndicators()
        return self._array(self.fmu.getEventIndicators, n)

    def derivative(self, unknown, known, seed):
        references = [self.variables[name].valueReference for name in (unknown, known)]
        return np.array(
            self.fmu.getDirectionalDerivative(
                *([reference] for reference in references), list(seed), self.size(unknown)
            )
        )


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmu")

    def of(scenario, **more):
        file = folder / f"{scenario.name}.fmu"
        if not file.exists():
            r3.export_fmu(scenario, file, **more)
        return str(file)

    return of


# --- Model Exchange -----------------------------------------------------------------------------


def run(importer, t_end, at_event=None, h=1e-4):
    """Heun's method with steps of `h` [s]; events are taken at the ends of steps."""
    next_event = importer.begin()
    t = 0.0
    while t < t_end - 1e-12:
        step = min(h, max(next_event - t, 0.0) if next_event > 0.0 else h, t_end - t)
        x, rate = importer.states, importer.derivatives
        for _ in range(2):
            importer.fmu.setTime(t + step)
            importer.states = x + step * rate
            rate = 0.5 * (rate + importer.derivatives)
        importer.states = x + step * rate
        t += step
        if importer.indicators.min() <= 0.0 or t == next_event:
            importer.fmu.enterEventMode()
            *_, defined, when = importer.fmu.updateDiscreteStates()
            next_event = when if defined else -1.0
            importer.fmu.enterContinuousTimeMode()
            if at_event:
                at_event(t)


def test_no_indicator_is_zero_after_an_event_and_what_sticks_does_not_move(path):
    """Not even in the hands of an integrator that knows nothing of events."""
    importer = Importer(path(MOVING), "ModelExchange")
    seen = []

    def look(t):
        assert importer.indicators.min() >= 1e-12
        sticks = importer.get("branch.friction") == 0
        assert (importer.get("rotor_rate")[sticks] == 0.0).all()
        assert (importer.get("joint_rate")[3:][sticks[3:]] == 0.0).all()
        seen.append(sticks.sum())

    run(importer, 0.3, look)
    assert len(seen) > 10 and min(seen) < 3 and max(seen) == 6


def test_an_importer_cannot_move_what_sticks(path):
    importer = Importer(path(MOVING), "ModelExchange")
    importer.begin()
    x = importer.states
    names = importer.get("state.joint_rate")
    assert (names == 0.0).all()
    first = sum(importer.size(f"state.{g}") for g in ("joint_angle",))
    x[first + 3] = 1e-9  # roundoff of a linear solver, on axis 4
    importer.states = x
    assert importer.get("rotor_rate")[3] == 0.0
    assert importer.derivatives[3] == 0.0


def test_samples_are_time_events(path):
    importer = Importer(path(SAMPLED), "ModelExchange")
    importer.fmu.exitInitializationMode()
    times = []
    *_, when = importer.fmu.updateDiscreteStates()
    for _ in range(5):
        times.append(when)
        importer.fmu.enterContinuousTimeMode()
        importer.fmu.setTime(when)
        importer.fmu.enterEventMode()
        *_, when = importer.fmu.updateDiscreteStates()
    assert times == [k * 0.008 for k in range(1, 6)]


def test_an_importer_may_let_the_clock_of_the_samples_tick(path):
    """However it rounds the instant; elsewhere it may not."""
    importer = Importer(path(SAMPLED), "ModelExchange")
    clock = [importer.variables["sampling"].valueReference]
    interval, shift = (c_double * 1)(), (c_double * 1)()
    references = (c_uint * 1)(*clock)
    importer.fmu.getIntervalDecimal(references, interval, (c_int * 1)())
    importer.fmu.getShiftDecimal(references, shift)
    assert (interval[0], shift[0]) == (0.008, 0.0)
    importer.begin()
    importer.fmu.setTime(0.008 * (1.0 - 1e-12))
    importer.fmu.enterEventMode()
    importer.fmu.setClock(clock, [True])
    *_, defined, when = importer.fmu.updateDiscreteStates()
    assert defined and when == 0.016
    importer.fmu.enterContinuousTimeMode()
    importer.fmu.setTime(0.012)
    importer.fmu.enterEventMode()
    with pytest.raises(Exception, match=r"failed with status 3 \(error\)"):
        importer.fmu.setClock(clock, [True])
    assert "expected ticks at multiples of 0.008 s, got one at 0.012 s" in importer.messages[-1][1]


def test_directional_derivatives_are_those_of_the_closed_form(path):
    """M(q) q'' + h = p rF: q'' depends on rF by p / M. Differences of four points: 1e-12."""
    importer = Importer(path(FREE), "ModelExchange")
    q = np.array([0.3, -0.5, 0.8, 0.1, -0.4, 0.2])
    importer.begin()
    x = importer.states
    x[:6] = q
    importer.states = x
    robot = FREE.robot
    p = np.array(robot.parameters["table_1"]["p"])
    exact = np.linalg.solve(robot.mass_matrix(q), np.diag(p))
    for axis, seed in enumerate(np.eye(6)):
        got = importer.derivative("joint_acceleration", "input.motor_torque", seed)
        assert got == pytest.approx(exact[:, axis], rel=1e-10, abs=1e-10 * abs(exact).max())
    seed = np.array([1.0, -2.0, 0.5, 0.0, 3.0, 1.0])
    got = importer.derivative("der(state.joint_rate)", "input.motor_torque", seed)
    assert got == pytest.approx(exact @ seed, rel=1e-10)
    assert (importer.states == x).all()


@pytest.mark.parametrize(
    ("unknown", "known"),
    [
        ("der(state.joint_rate)", "joint_angle"),
        ("joint_acceleration", "joint_rate"),
        ("der(state.rotor_rate)", "deflection"),
        ("gear_torque", "deflection"),
        ("der(state.rotor_rate)", "pt2_torque"),
        ("der(state.voltage)", "controller"),
    ],
)
def test_directional_derivatives_by_states_are_those_of_differences(path, unknown, known):
    importer = Importer(path(MOVING), "ModelExchange")
    run(importer, 0.05)
    x = importer.states
    start = importer.get(f"state.{known}")
    seed = np.cos(np.arange(len(start)))
    got = importer.derivative(unknown, f"state.{known}", seed)
    place = next(k for k in range(len(x)) if (x[k : k + len(start)] == start).all())
    h = 1e-6

    def at(distance):
        moved = x.copy()
        moved[place : place + len(seed)] += distance * seed
        importer.states = moved
        return importer.get(unknown)

    assert abs(got).max() > 0.1
    # The difference of two points, 1e-6 apart, has errors of 1e-16 / 1e-6 of the size of the terms.
    differences = (at(h) - at(-h)) / (2.0 * h)
    assert got == pytest.approx(differences, rel=1e-5, abs=1e-5 * abs(differences).max())


# --- Co-Simulation ------------------------------------------------------------------------------


def steps(importer, n, h=0.01, begin=0):
    """The motor torques after each step."""
    torques = []
    for k in range(begin, begin + n):
        importer.fmu.doStep(k * h, h)
        torques.append(importer.get("motor_torque"))
    return np.array(torques)


@pytest.mark.parametrize("scenario", [MOVING, SAMPLED], ids=lambda s: s.name)
def test_a_state_continues_bit_by_bit_in_another_instance(path, scenario):
    first = Importer(path(scenario), "CoSimulation")
    first.begin()
    steps(first, 13)
    state = first.fmu.getFMUState()
    as_bytes = first.fmu.serializeFMUState(state)
    expected = steps(first, 10, begin=13)
    first.fmu.setFMUState(state)
    assert (steps(first, 10, begin=13) == expected).all()
    first.fmu.freeFMUState(state)

    second = Importer(path(scenario), "CoSimulation")
    second.fmu.setFMUState(second.fmu.deserializeFMUState(as_bytes))
    assert (steps(second, 10, begin=13) == expected).all()
    assert second.get("n_events") == first.get("n_events")


def test_a_state_of_model_exchange_continues_bit_by_bit(path):
    importer = Importer(path(MOVING), "ModelExchange")
    run(importer, 0.05)
    as_bytes = importer.fmu.serializeFMUState(importer.fmu.getFMUState())
    seen = [importer.states, importer.derivatives, importer.indicators]
    other = Importer(path(MOVING), "ModelExchange")
    other.fmu.setFMUState(other.fmu.deserializeFMUState(as_bytes))
    for got, expected in zip(
        [other.states, other.derivatives, other.indicators], seen, strict=True
    ):
        assert (got == expected).all()
    assert other.fmu.serializeFMUState(other.fmu.getFMUState()) == as_bytes


def test_instances_in_threads_do_not_disturb_each_other(path):
    def simulate(mass):
        importer = Importer(path(MOVING), "CoSimulation")
        importer.set("load.mass", mass)
        importer.begin()
        return steps(importer, 20)

    masses = [0.0, 15.0, 5.0, 10.0]
    alone = [simulate(mass) for mass in masses]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(simulate, masses))
    assert all((a == b).all() for a, b in zip(alone, together, strict=True))
    assert (alone[0] != alone[1]).any()


def test_intermediate_updates_tell_of_steps_and_end_them_early(path):
    told = []

    def update(environment, t, may_set, may_get, finished, may_return, wanted, until):
        told.append(t)
        assert may_get and finished and not may_set
        if t >= 0.1:
            wanted[0] = True
            until[0] = t

    importer = Importer(
        path(MOVING), "CoSimulation", early_return_allowed=True, intermediate_update=update
    )
    importer.begin()
    event, _, early, time = importer.fmu.doStep(0.0, 0.3)
    assert early and not event and time == told[-1] == importer.get("time")
    assert 0.1 <= time < 0.11 and len(told) > 20 and sorted(told) == told


def test_a_reference_goes_on_with_its_rate(path):
    scenario = r3.Scenario("outside", r3.Robot(3), r3.Hold([0.0] * 6), 0.5)
    importer = Importer(path(scenario, reference="input"), "CoSimulation")
    importer.begin()
    importer.set("input.reference_rate", [0.5] * 6)
    importer.fmu.doStep(0.0, 0.02)
    assert importer.get("reference_angle") == pytest.approx([0.01] * 6, rel=1e-12)
    importer.set("input.reference_angle", [0.02] * 6)
    assert (importer.get("reference_angle") == 0.02).all()
    importer.fmu.doStep(0.02, 0.02)
    assert importer.get("reference_angle") == pytest.approx([0.03] * 6, rel=1e-12)


# --- what it tells ------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
def test_the_log_tells_every_event(path, kind):
    importer = Importer(path(MOVING), kind)
    if kind == "CoSimulation":
        importer.begin()
        steps(importer, 30)
    else:
        run(importer, 0.3)
    told = [text for category, text in importer.messages if category == "logEvents"]
    assert len(told) == importer.get("n_events")[0]
    events = r3.simulate(MOVING.robot, MOVING.motion, t_end=0.3).events
    expected = [f"{e.element.replace('_', ' ')} of axis {e.axis}, {e.before} -> {e.after}"
                for e in events if e.element != "reference"]  # fmt: skip
    if kind == "CoSimulation":
        assert [text.split(": ", 1)[1] for text in told] == expected
    else:  # Heun's method finds them in nearly the same order
        assert sorted(text.split(": ", 1)[1] for text in told)[:3] == sorted(expected)[:3]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("load.mass", 20.0, "mass: expected 0 to 15 kg, got 20 kg"),
        ("load.mass", np.nan, "load.mass: expected finite numbers [kg], got nan"),
        ("table_1.K_S", [-1.0] * 6, "table_1 K_S of axis 1: expected"),
        ("joint_angle", [0.0] * 6, "joint_angle: it cannot be set"),
        ("input.tip_force", [np.inf, 0.0, 0.0], "input.tip_force: expected finite numbers [N]"),
    ],
)
def test_wrong_values_are_refused_with_a_message(path, name, value, message):
    importer = Importer(path(MOVING), "CoSimulation")
    with pytest.raises(Exception, match=r"failed with status 3 \(error\)"):
        importer.set(name, value)
        importer.begin()
    [(category, text)] = [m for m in importer.messages if m[0] != "logEvents"]
    assert category == "logStatusError" and message in text


def test_parameters_are_fixed_when_initialisation_has_ended(path):
    importer = Importer(path(MOVING), "CoSimulation")
    importer.begin()
    with pytest.raises(Exception, match=r"failed with status 3 \(error\)"):
        importer.set("load.mass", 1.0)
    assert "it can be set until initialisation ends" in importer.messages[-1][1]
    assert importer.get("load.mass") == 15.0


def test_a_communication_point_must_be_where_the_instance_is(path):
    importer = Importer(path(MOVING), "CoSimulation")
    importer.begin()
    importer.fmu.doStep(0.0, 0.01)
    with pytest.raises(Exception, match=r"failed with status 3 \(error\)"):
        importer.fmu.doStep(0.5, 0.01)
    assert "communication point: expected 0.01 s, got 0.5" in importer.messages[-1][1]


def test_another_token_is_refused(path, tmp_path):
    description = fmpy.read_model_description(path(MOVING))
    description.guid = "{another}"
    told = []
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmpy.instantiate_fmu(
            fmpy.extract(path(MOVING)),
            description,
            "CoSimulation",
            logger=lambda _, status, category, text: told.append(text.decode()),
        )
    assert "instantiation token: expected {" in told[0] and "got {another}" in told[0]
