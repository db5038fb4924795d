"""The core is built once for each kind of processor: all builds simulate the same robot.

A process uses one build. What the others compute comes from processes of their own, pickled.
"""

import os
import pickle
import re
import subprocess
import sys
from dataclasses import FrozenInstanceError
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from oracle_runs import times_of

import manutec_r3 as r3
from manutec_r3 import processor
from manutec_r3.comparison.accuracy import ranges, sequence

CPU = Path("/proc/cpuinfo")

# Builds round differently, so that some steps come out otherwise: instants of events, which hardly
# depend on the steps, are off by up to 5e-15 s, signals by up to 8e-9 of their range, a fraction of
# what the tolerance of 5e-8 lets pass. Ten times that.
TIMES = 5e-14
SIGNALS = 1e-7

# Model 3, the same with a sampled controller, the Modelica variant.
SAMPLE = """
import pickle, sys
import manutec_r3 as r3
robot = r3.Robot(model=3, load=r3.Load(mass=15.0))
motion = r3.Quintic([0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)
results = [
    r3.simulate(robot, motion, t_end=0.4),
    r3.simulate(robot.replace(controller="sampled"), motion, t_end=0.4),
    r3.Scenario.load("full-robot").run(t_end=0.4),
]
sys.stdout.buffer.write(pickle.dumps((r3.build_info(), results)))
"""


def process(build, script=SAMPLE):
    """What a process with this build writes."""
    return subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | {"MANUTEC_R3_PROCESSOR": build},
        capture_output=True,
    )


@cache
def pickled(build):
    done = process(build)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def sample(build):
    """Information about a build, and results of it."""
    return pickle.loads(pickled(build))


def assert_same(one, other):
    assert one.events == other.events
    np.testing.assert_array_equal(one.time, other.time)
    for signal in one.signals:
        np.testing.assert_array_equal(getattr(one, signal), getattr(other, signal))


# --- which build ------------------------------------------------------------------------------


def test_the_fastest_build_is_taken_unless_another_is_asked_for():
    expected = os.environ.get("MANUTEC_R3_PROCESSOR", processor.builds[-1])
    assert r3.build_info().processor == expected
    assert process("", "import manutec_r3 as r3; print(r3.build_info().processor)").stdout == (
        f"{processor.builds[-1]}{os.linesep}".encode()
    )


@pytest.mark.parametrize("build", processor.builds)
def test_a_build_that_is_asked_for_is_taken(build):
    assert sample(build)[0].processor == build


def test_a_build_that_does_not_exist_is_refused():
    done = process("pdp-11")
    assert done.returncode != 0
    known = ", ".join(processor.builds)
    assert (
        f"ImportError: MANUTEC_R3_PROCESSOR: expected one of {known} on this processor, "
        "got 'pdp-11'"
    ) in done.stderr.decode()


@pytest.mark.skipif(not CPU.exists(), reason="only Linux tells what its processor can do")
@pytest.mark.skipif(
    not any(Path(r3.__file__).parent.glob("_core_x86_64_v3.*")),
    reason="this compiler or machine knows no x86-64-v3",
)
def test_the_build_for_avx2_and_fma_runs_where_the_processor_has_them():
    flags = set(re.search(r"^flags\s*:(.*)$", CPU.read_text(), re.M)[1].split())
    needed = {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"}
    assert ("x86-64-v3" in processor.builds) == (needed <= flags)


# --- what it says of itself -------------------------------------------------------------------


def test_build_info_is_of_this_machine_and_cannot_be_changed():
    info = r3.build_info()
    assert info.version == version("manutec-r3")
    assert info.available == processor.builds
    assert info.processor in info.available
    assert re.match(r"\w+ \d+\.\d+", info.compiler)
    assert re.fullmatch(r"7\.\d+\.\d+", info.sundials)
    assert re.fullmatch(r"3\.4\.\d+", info.eigen)
    with pytest.raises(FrozenInstanceError):
        info.processor = "other"
    assert repr(info).startswith("BuildInfo(version=")


@pytest.mark.parametrize("build", processor.builds)
def test_flags_are_those_of_the_build(build):
    flags = sample(build)[0].flags
    assert ("-march=x86-64-v3" in flags) == (build == "x86-64-v3")


# --- what it computes -------------------------------------------------------------------------


@pytest.mark.parametrize("build", processor.builds)
def test_a_build_repeats_bit_by_bit(build):
    again = pickle.loads(process(build).stdout)[1]
    for one, other in zip(sample(build)[1], again, strict=True):
        assert_same(one, other)


@pytest.mark.parametrize("build", processor.builds[1:])
def test_builds_find_the_same_events_and_signals(build):
    for one, other in zip(sample("baseline")[1], sample(build)[1], strict=True):
        assert sequence(one.events) == sequence(other.events)
        assert times_of(other.events) == pytest.approx(times_of(one.events), rel=0, abs=TIMES)
        times = np.linspace(0.0, one.t_end, 101)
        for signal in ("joint_angle", "control_error", "motor_torque"):
            values = getattr(one.at(times), signal)
            difference = np.abs(getattr(other.at(times), signal) - values).max(axis=0)
            assert (difference <= SIGNALS * ranges(values)).all(), signal


# --- pickles ----------------------------------------------------------------------------------


@pytest.mark.parametrize("build", processor.builds)
def test_pickles_name_no_build(build):
    assert b"manutec_r3._core" in pickled(build)
    assert b"_core_" not in pickled(build)


@pytest.mark.parametrize("build", processor.builds)
def test_results_of_any_build_are_read_by_this_one(build):
    for result in sample(build)[1]:
        assert pickle.loads(pickle.dumps(result)).events == result.events
        # The dense output begins each step where the other build did.
        np.testing.assert_array_equal(result.at(0.0).state, result.state[:1])
