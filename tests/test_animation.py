"""The robot in three dimensions: what the page shows in a real browser, and the live view."""

import re
import shutil
import sys
from base64 import b64decode
from io import BytesIO

import matplotlib.image
import numpy as np
import pytest

import manutec_r3 as r3
from manutec_r3.animation import Animation, LiveView, meshes
from manutec_r3.animation.elements import WORDS
from manutec_r3.animation.poses import arm_poses
from manutec_r3.shapes import floor_height

CHROMIUM = shutil.which("chromium")
DRIVER = shutil.which("chromedriver")
needs_browser = pytest.mark.skipif(
    not (CHROMIUM and DRIVER),
    reason="needs Debian's chromium and chromium-driver: apt-get install chromium chromium-driver",
)

FLOAT32 = 2e-7  # poses are sent with 24 bits; lengths are below 2 m


@pytest.fixture(scope="module")
def result():
    return r3.Scenario.load("figure9-quintic").run()


def without_motion():
    robot = r3.Robot(model=3, controller=None)
    leaning = robot.state_from(joint_angle=[0.1, 0.3, 0.4, 0.0, 0.3, 0.0])
    return r3.simulate(robot, None, t_end=0.2, start=leaning)


RUNS = {
    "model 1": lambda: r3.simulate(r3.Robot(model=1), r3.Hold([0.3] * 6), t_end=0.1),
    "model 2": lambda: r3.simulate(r3.Robot(model=2), r3.Hold([0.0, 1.0, -1.0]), t_end=0.1),
    "model 4": lambda: r3.simulate(
        r3.Robot(model=4), r3.Quintic([0] * 3, [0.5, 0.4, -0.6], 0.5), t_end=0.6
    ),
    "sampled": lambda: r3.simulate(
        r3.Robot(model=3, controller="sampled"), r3.Hold([0.1] * 6), 0.05, list_samples=True
    ),
    "full-robot": lambda: r3.Scenario.load("full-robot").run(),
    "one-axis": lambda: r3.Scenario.load("one-axis").run(),
    "without a motion": without_motion,
}


# --- in the browser ------------------------------------------------------------------------------


class Browser:
    """Chromium without a window and without a network, with WebGL computed in software."""

    def __init__(self):
        from selenium import webdriver
        from selenium.webdriver.support.wait import WebDriverWait

        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        for argument in (
            "--headless=new",
            "--no-sandbox",  # which root cannot have
            "--disable-dev-shm-usage",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--window-size=760,600",
            "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",
        ):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
        self.wait = WebDriverWait(self.driver, 30.0, 0.05).until

    def open(self, address):
        self.driver.get_log("browser")  # what was said before is told no more
        self.driver.get(address)

    def show(self, path, instant=""):
        self.open(path.as_uri() + instant)
        self.wait(lambda _: self.run("document.body.dataset.ready"))

    def run(self, script):
        return self.driver.execute_script(f"return {script}")

    def complaints(self):
        return [line for line in self.driver.get_log("browser") if line["level"] != "INFO"]

    def pose(self, arm, of="pose"):
        return np.reshape(self.run(f"animation.{of}('{arm}')"), (4, 4)).T

    def slide(self, time):
        """Move the slider, as a hand would, and tell those who listen."""
        self.driver.execute_script(
            "const slider = document.getElementById('slider');"
            f"slider.value = {float(time)!r}; slider.dispatchEvent(new Event('input'));"
        )

    def seek(self, time):
        """Go to an instant exactly; a slider rounds."""
        self.run(f"animation.seek({float(time)!r})")

    def text(self, where):
        return [e.text for e in self.driver.find_elements("css selector", where)]

    def picture(self):
        # One frame later what was asked for has been drawn.
        self.driver.execute_async_script(
            "const done = arguments[0];requestAnimationFrame(() => requestAnimationFrame(done));"
        )
        png = self.driver.find_element("id", "stage").screenshot_as_png
        return matplotlib.image.imread(BytesIO(png))[..., :3]


@pytest.fixture(scope="module")
def animation(result):
    return result.animate()


@pytest.fixture(scope="module")
def browser():
    browser = Browser()
    yield browser
    browser.driver.quit()


@pytest.fixture
def page(browser, animation, tmp_path_factory):
    """The page of the benchmark experiment, as it is when it has been opened."""
    path = tmp_path_factory.getbasetemp() / "figure9.html"
    if not path.exists():
        animation.save(path)
    if browser.driver.current_url != path.as_uri():
        browser.show(path)
    browser.slide(0.0)
    browser.run("animation.look('oblique')")
    return browser


@needs_browser
@pytest.mark.parametrize("run", RUNS)
def test_the_page_of_every_kind_of_run_opens_without_a_complaint(browser, run, tmp_path):
    result = RUNS[run]()
    result.animate(tmp_path / "run.html")
    browser.show(tmp_path / "run.html")
    browser.slide(0.5 * result.t_end)
    assert browser.complaints() == []
    assert len(browser.text(".axis")) == result.robot.n_axes
    assert bool(browser.text("#ghost")[0]) == (result.motion is not None)


@needs_browser
def test_the_page_asks_for_nothing_else(page):
    assert page.run("performance.getEntriesByType('resource').map((entry) => entry.name)") == []


@needs_browser
def test_an_address_can_say_when_to_begin(page, tmp_path_factory):
    page.open("about:blank")
    page.show(tmp_path_factory.getbasetemp() / "figure9.html", "#0.7")
    assert page.run("animation.time") == 0.7


@needs_browser
def test_the_slider_moves_the_robot_and_its_reference(page, result):
    for time in (0.0, 0.55, 1.1, 1.5):  # frames of the page, 5 ms apart
        page.slide(time)
        now = result.at(time)
        frames = result.robot.link_poses(now.joint_angle)[0]
        ghosts = result.robot.link_poses(now.reference_angle)[0]
        for arm in range(1, 7):
            np.testing.assert_allclose(page.pose(f"arm_{arm}"), frames[arm], atol=FLOAT32)
            ghost = page.pose(f"arm_{arm}", "referencePose")
            np.testing.assert_allclose(ghost, ghosts[arm], atol=FLOAT32)


@needs_browser
def test_between_frames_the_robot_is_where_it_was_to_a_tenth_of_a_millimetre(page, result):
    time = 0.5525  # the middle of two frames; arms turn by up to 10 rad/s^2, and 5 ms do not matter
    page.slide(time)
    frames = result.robot.link_poses(result.at(time).joint_angle)[0]
    np.testing.assert_allclose(page.pose("arm_6"), frames[6], atol=1e-4)


@needs_browser
def test_the_load_is_carried(page, result):
    page.slide(0.8)
    carried = page.pose("load")
    np.testing.assert_allclose(carried, page.pose("arm_6"), atol=1e-15)


@needs_browser
def test_play_advances_to_the_end_and_pause_stops(page):
    button = page.driver.find_element("id", "play")
    assert page.run("animation.time") == 0.0
    button.click()
    page.wait(lambda _: page.run("animation.time") > 0.0)
    button.click()
    assert not page.run("animation.playing")
    stopped = page.run("animation.time")
    page.picture()
    assert page.run("animation.time") == stopped

    page.seek(1.45)
    button.click()
    page.wait(lambda _: not page.run("animation.playing"))
    assert page.run("animation.time") == 1.5
    button.click()  # from the beginning
    assert page.run("animation.time") < 1.5


@needs_browser
def test_something_is_drawn_and_it_moves(page):
    start = page.picture()
    assert len(np.unique(np.rint(255 * start).reshape(-1, 3), axis=0)) > 500  # shaded, not blank
    page.slide(0.6)
    later = page.picture()
    moved = (np.abs(later - start).max(axis=-1) > 0.1).mean()
    assert 0.01 < moved < 0.5  # arms are some percent of the picture, floor and base stay
    page.run("animation.look('top')")
    assert (np.abs(page.picture() - later).max(axis=-1) > 0.1).mean() > 0.05


@needs_browser
def test_dragging_turns_the_camera_and_not_the_robot(page):
    from selenium.webdriver import ActionChains

    before, pose = page.picture(), page.pose("arm_3")
    stage = page.driver.find_element("id", "stage")
    hand = ActionChains(page.driver).move_to_element_with_offset(stage, -200, 0)
    hand.click_and_hold().move_by_offset(120, 30).release().perform()
    assert (np.abs(page.picture() - before).max(axis=-1) > 0.1).mean() > 0.02
    np.testing.assert_array_equal(page.pose("arm_3"), pose)


@needs_browser
def test_the_panel_says_what_each_axis_does(page, result):
    for time in (0.05, 0.7, 1.4):
        page.slide(time)
        now = result.at(time)
        torques = [float(t.split()[0].replace("\N{MINUS SIGN}", "-")) for t in page.text(".torque")]
        errors = [float(t.split()[1].replace("\N{MINUS SIGN}", "-")) for t in page.text(".error")]
        # Two digits are shown. Frames are at these instants.
        np.testing.assert_allclose(torques, now.motor_torque[0], atol=0.0051)
        np.testing.assert_allclose(errors, 1e3 * now.control_error[0], atol=0.0051)
        friction = [WORDS["friction"][branch + 1] for branch in now.branches["friction"][0]]
        assert page.text(".friction") == friction


@needs_browser
def test_branches_switch_exactly_at_their_events(page, result):
    for element, where, shown in (
        ("friction", ".friction", WORDS["friction"]),
        ("backlash", ".mark:nth-child(3)", ("contact \N{MINUS SIGN}", "gap", "contact +")),
    ):
        event = next(e for e in result.events if (e.axis, e.element) == (1, element))
        page.seek(np.nextafter(event.time, 0.0))
        assert page.text(f".axis:first-child {where}") == [shown[event.before + 1]]
        page.seek(event.time)
        assert page.text(f".axis:first-child {where}") == [shown[event.after + 1]]


@needs_browser
def test_a_mark_is_lit_in_the_dead_zone(page, result):
    mark = page.driver.find_element("css selector", ".axis:nth-child(5) .mark")
    crossing = [e for e in result.events if (e.axis, e.element) == (5, "dead_zone")]
    for event in crossing:
        page.seek(event.time)
        assert ("on" in mark.get_attribute("class").split()) == (event.after == 0)


@needs_browser
def test_buttons_lead_from_event_to_event(page, result):
    instants = np.unique(result.events.time)
    for expected in instants[:3]:
        page.driver.find_element("id", "forth").click()
        assert page.run("animation.time") == expected
    page.driver.find_element("id", "back").click()
    assert page.run("animation.time") == instants[1]


@needs_browser
def test_nothing_overlaps_in_small_windows(page):
    for width, height in ((1280, 800), (800, 600)):
        page.driver.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
        )
        boxes = page.run(
            "['header', '#axes', '#transport'].map((name) => {"
            "  const box = document.querySelector(name).getBoundingClientRect();"
            "  return [box.left, box.right, box.top, box.bottom]; })"
        )
        for k, (left, right, top, bottom) in enumerate(boxes):
            assert 0 <= left < right <= width
            assert 0 <= top < bottom <= height
            for other in boxes[:k]:
                apart = (
                    left >= other[1] or right <= other[0] or top >= other[3] or bottom <= other[2]
                )
                assert apart
        # No line of an axis is cut off.
        assert page.run(
            "[...document.querySelectorAll('.axis')]"
            ".every((axis) => axis.scrollWidth <= axis.clientWidth)"
        )
    page.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@needs_browser
def test_a_notebook_shows_it(browser, tmp_path):
    animation = RUNS["model 4"]().animate()
    notebook = tmp_path / "notebook.html"
    notebook.write_text(f"<!DOCTYPE html><body>{animation._repr_html_()}", encoding="utf-8")
    browser.open(notebook.as_uri())
    browser.wait(lambda _: browser.run("frames[0].document.body?.dataset.ready"))
    assert browser.complaints() == []


# --- the file ------------------------------------------------------------------------------------


def test_the_page_names_the_licence_of_what_it_contains(animation):
    licence = r"@license\s+\* Copyright [-\d]+ Three.js Authors\s+\* SPDX.*: MIT"
    assert re.search(licence, animation.html)


def test_long_runs_keep_the_page_below_three_megabytes():
    still = r3.simulate(r3.Robot(model=1), r3.Hold([0.3] * 6), t_end=60.0)
    assert len(still.animate().html) < 3e6


def test_without_a_path_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert isinstance(RUNS["model 2"]().animate(), Animation)
    assert list(tmp_path.iterdir()) == []


def test_the_ghost_can_be_magnified(result):
    html = result.animate(rate=10.0, magnify=20.0).html
    sent = b64decode(re.search(r'"reference_poses": "(.*?)"', html)[1])
    now = result.at(np.linspace(0.0, 1.5, 16))
    expected = arm_poses(result.robot, now.joint_angle + 20.0 * now.control_error)
    np.testing.assert_allclose(np.frombuffer(sent, "<f4"), expected.ravel(), atol=FLOAT32)
    assert "control error 20 times" in html


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"rate": 0.0}, ValueError, r"rate: expected frames per second \[1/s\] above 0.*got 0"),
        ({"rate": float("nan")}, ValueError, r"rate: expected a finite number \[1/s\]"),
        ({"rate": 1e9}, ValueError, r"rate: .* up to 1e\+06, got 1e\+09"),
        ({"rate": "fast"}, TypeError, r"rate: expected one number \[1/s\], got 'fast'"),
        ({"magnify": -1.0}, ValueError, r"magnify: expected a positive number, got -1"),
        ({"magnify": True}, TypeError, r"magnify: expected one number"),
        ({"path": 3}, TypeError, r"path: expected a name of a file, got 3"),
    ],
)
def test_wrong_input_is_refused(arguments, error, message):
    result = RUNS["model 2"]()
    with pytest.raises(error, match=message):
        result.animate(**arguments)


# --- shapes --------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", [1, 2, 3, 4, "full-robot", "one-axis"])
def test_parts_reach_from_the_floor_to_the_tip(model):
    robot = r3.Robot(model=model)
    world, *arms = robot.link_poses(np.zeros(robot.n_axes))[:, 2, 3]
    height = {"base": world, "load": arms[5]} | {f"arm_{k + 1}": z for k, z in enumerate(arms)}
    heights = np.concatenate(
        [
            mesh.vertices[:, 2] + height[arm]
            for arm, parts in meshes.arms(robot).items()
            for _, mesh in parts
        ]
    )
    assert heights.min() == pytest.approx(floor_height(robot), abs=1e-12)
    assert heights.max() > arms[5]


def test_every_joint_has_its_mark():
    arms = meshes.arms(r3.Robot(model=3))
    for arm in range(1, 7):
        assert [material for material, _ in arms[f"arm_{arm}"]].count("branch") == 1


def test_the_load_is_a_ball_of_steel_where_the_load_is():
    robot = r3.Robot(model=3, load=r3.Load(10.0, (0.05, -0.02, 0.2)))
    mesh = dict(meshes.arms(robot)["load"])["load"]
    np.testing.assert_allclose(mesh.bounds.mean(axis=0), robot.load.position, atol=1e-12)
    # The ball is an icosphere, which fills 99 % of its ball; 7850 kg/m^3.
    assert mesh.volume == pytest.approx(10.0 / 7850.0, rel=0.02)


def test_no_load_no_ball():
    assert "load" not in meshes.arms(r3.Robot(model=3))


def test_poses_are_those_of_the_core():
    robot = r3.Robot(model=3)
    angle = np.random.default_rng(1).uniform(-2.0, 2.0, (20, 6))
    poses, frames = arm_poses(robot, angle), robot.link_poses(angle)[:, 1:]
    np.testing.assert_array_equal(poses[..., :3], frames[..., :3, 3])
    # The first row of the rotation that a unit quaternion stands for.
    x, y, z, w = np.moveaxis(poses[..., 3:], -1, 0)
    row = np.stack((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)), axis=-1)
    np.testing.assert_allclose(row, frames[..., 0, :3], atol=1e-14)  # roundoff


# --- live ----------------------------------------------------------------------------------------


@pytest.fixture
def live():
    robot = r3.Robot(model=3, load=r3.Load(15.0))
    motion = r3.Quintic([0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], 1.2)
    with LiveView(r3.Simulator(robot, motion), port=0) as view:
        yield view


def arms_shown(view, name):
    return [(arm.position, arm.wxyz) for arm in view._arms[name]]


def test_stepping_moves_what_is_seen(live):
    sim = live.simulator
    live.step(0.6)
    assert sim.time == 0.6
    event = live.step_to_event()
    assert sim.time == event.time
    for name, angle in (("robot", sim.joint_angle), ("reference", sim.reference_angle)):
        (poses,) = arm_poses(sim.robot, angle[None])
        for (position, wxyz), pose in zip(arms_shown(live, name), poses, strict=True):
            np.testing.assert_array_equal(position, pose[:3])
            np.testing.assert_array_equal(np.roll(wxyz, -1), pose[3:])


def test_update_shows_what_was_stepped_elsewhere(live):
    live.simulator.step(0.9)
    live.update()
    (poses,) = arm_poses(live.simulator.robot, live.simulator.joint_angle[None])
    np.testing.assert_array_equal(arms_shown(live, "robot")[5][0], poses[5, :3])
    assert "**0.900000 s**" in live._table.content


@needs_browser
def test_a_button_on_the_page_steps(live, browser):
    browser.open(live.url)
    button = "//button[normalize-space()='step']"
    browser.wait(lambda driver: driver.find_elements("xpath", button))
    browser.driver.find_element("xpath", button).click()
    browser.wait(lambda _: live.simulator.time == 0.01)
    browser.open("about:blank")


def test_a_robot_without_motion_has_no_ghost():
    sim = r3.Simulator(r3.Robot(model=2, controller=None))
    with LiveView(sim, port=0) as view:
        view.step(0.01)
        assert list(view._arms) == ["robot"]
        assert "none" in view._table.content


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"simulator": "robot"}, TypeError, r"simulator: expected a Simulator, got 'robot'"),
        ({"dt": 0.0}, ValueError, r"dt: expected a positive time, got 0 s"),
        ({"port": 70000}, ValueError, r"port: expected a number from 0 to 65535, got 70000"),
        ({"port": "http"}, TypeError, r"port: expected a number from 0 to 65535, got 'http'"),
    ],
)
def test_a_wrong_live_view_is_refused(arguments, error, message):
    sim = r3.Simulator(r3.Robot(model=2), r3.Hold([0.0] * 3))
    with pytest.raises(error, match=message):
        LiveView(**{"simulator": sim} | arguments)


@pytest.mark.parametrize(
    ("library", "extra", "use"),
    [
        ("trimesh", "animation", lambda: RUNS["model 2"]().animate()),
        ("scipy.spatial.transform", "animation", lambda: RUNS["model 2"]().animate()),
        ("viser", "live", lambda: LiveView(r3.Simulator(r3.Robot(model=2), r3.Hold([0.0] * 3)))),
    ],
)
def test_what_is_missing_says_what_to_install(monkeypatch, library, extra, use):
    monkeypatch.setitem(sys.modules, library, None)
    if extra == "animation":
        for name in [name for name in sys.modules if name.startswith("manutec_r3.animation")]:
            monkeypatch.delitem(sys.modules, name)
    with pytest.raises(ImportError, match=rf'pip install "manutec-r3\[{extra}\]"'):
        use()
