"""What a notebook shows: tables whose cells are the numbers of the objects."""

from html.parser import HTMLParser

import numpy as np
import pytest

import manutec_r3 as r3


class Tables(HTMLParser):
    """Captions and cells of all tables; complains of a tag that is not closed."""

    def __init__(self, text):
        super().__init__()
        self.captions, self.rows, self._open = [], [], []
        self.feed(text)
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("th", "td"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        if self._open[-1] == "caption":
            self.captions.append(data)
        else:
            self.rows[-1][-1] += data

    @property
    def facts(self):
        return dict(row for row in self.rows if len(row) == 2)


def shown(thing):
    return Tables(thing._repr_html_())


def test_a_robot_shows_its_load_and_options():
    robot = r3.Robot(4, r3.Load(5.0), table_1={"K_V": {2: 0.35}}, voltage_limit=8.0)
    tables = shown(robot)
    assert tables.captions == ["Manutec r3, model 4"]
    facts = tables.facts
    assert facts["states"] == "36"
    assert facts["load"] == "5 kg at (0, 0, 0.25) m"
    assert facts["rotor coupling"] == "simplified, simplified, simplified"
    assert facts["voltage limit"] == "8 V"
    assert facts["own table 1"] == "{'K_V': {2: 0.35}}"
    assert "stiffness" not in facts  # of springs that there are not
    soft = shown(r3.Robot(3, stiction="stiff-spring", stiffness=2e7)).facts
    assert soft["stiffness"] == "2e+07 N m/rad, N m s/rad"
    assert shown(r3.Robot(1, controller=None)).facts["controller"] == "none"


@pytest.mark.parametrize(
    "motion",
    [
        r3.Quintic([0.1, 0.2, 0.3], [1.0, -2.0, 0.5], 1.2),
        r3.Hold([0.1, -0.2, 0.3]),
        r3.FunctionMotion(lambda t: [t, 2.0 * t, 0.0], lambda t: [1.0, 2.0, 0.0], 0.5),
    ],
)
def test_a_motion_shows_where_it_begins_and_ends(motion):
    tables = shown(motion)
    assert tables.captions[0].startswith(f"{type(motion).__name__}: {motion.duration:g} s, knots")
    assert tables.rows[0] == ["axis", "start [rad]", "end [rad]"]
    ends = np.array([row[1:] for row in tables.rows[1:]], float).T
    np.testing.assert_array_equal(ends, [motion.angle(0.0), motion.angle(motion.duration)])


def test_a_scenario_shows_what_it_is_made_of():
    scenario = r3.Scenario.load("figure9-quintic")
    tables = shown(scenario)
    assert tables.captions == [
        f"figure9-quintic: {scenario.description}",
        *shown(scenario.robot).captions,
        *shown(scenario.motion).captions,
    ]
    assert tables.facts["end"] == "1.5 s"


def test_a_result_shows_its_peaks():
    result = r3.Scenario.load("figure9-quintic").run()
    tables = shown(result)
    assert tables.facts["status"] == "completed"
    assert tables.facts["events"] == "60"
    first_axis = tables.rows[-6]
    # two independent implementations of the model print the peaks of error and torque
    assert first_axis[:1] + first_axis[3:5] == ["1", "8.09", "2.81"]
    assert float(first_axis[5]) == pytest.approx(abs(result.motor_power[:, 0]).max(), abs=5e-3)


def test_a_result_without_a_motion_is_shown_as_well():
    result = r3.simulate(r3.Robot(2, controller=None), None, 0.05, motor_torque=[1.0, 0.0, 0.0])
    assert shown(result).rows[-3][3] == "-"  # no control error


def test_a_table_of_events_ends_where_a_reader_does():
    events = r3.Scenario.load("figure9-quintic").run().events
    tables = shown(events)
    assert tables.captions == ["60 events"]
    assert tables.rows[0] == ["time [s]", "axis", "element", "before", "after"]
    first = events[0]
    time, *others = tables.rows[1]
    assert float(time) == pytest.approx(first.time, abs=5e-10)
    assert others == [str(first.axis), "dead zone", str(first.before), str(first.after)]
    longer = r3.Events([first] * 1000)
    assert shown(longer).captions == ["1000 events, the first 60"]
    assert len(shown(longer).rows) == 61


def test_texts_are_no_markup():
    scenario = r3.Scenario("a<b", r3.Robot(4), r3.Hold([0.0] * 3), 1.0, description="x & <script>")
    assert shown(scenario).captions[0] == "a<b: x & <script>"
    assert "<script>" not in scenario._repr_html_()
