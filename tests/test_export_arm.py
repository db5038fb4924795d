"""The arm as URDF and MJCF: Pinocchio, MuJoCo and Drake read it, and it moves there as here."""

import json
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from child import child
from typer.testing import CliRunner

import manutec_r3 as r3
from manutec_r3.command_line import app
from manutec_r3.export.arm.tree import arm_tree
from manutec_r3.shapes import MATERIALS

# Accelerations in parts of the largest of a pose: all axes are coupled, so what is lost of one is
# lost of all. Measured: 5e-14, which is the grain of inertia that stands in for none of arm 6, by
# that of its rotor; where arm 6 has inertia 8e-15, roundoff. 1e-12 is what is promised.
AGREEMENT = 1e-12


def simplified(model=1, **options):
    return r3.Robot(model=model, rotor_coupling="simplified", **options)


ROBOTS = {
    "no load": simplified(),
    "load on axis 6": simplified(load=r3.Load(15.0)),
    "load beside axis 6": simplified(load=r3.Load(7.0, (0.05, -0.02, 0.2))),
    "light load": simplified(load=r3.Load(0.1, (0.0, 0.1, 0.15))),
    "I33 of arm 6 known": simplified(table_3={"arms": {6: {"I33": 0.01}}}),
    "three arms": simplified(2, load=r3.Load(15.0)),
    "three of six arms": simplified(2, arm="six-arm", load=r3.Load(3.0)),
    "full-robot": simplified("full-robot"),
    "one-axis": simplified("one-axis"),
}
WRITE = {"urdf": r3.export_urdf, "xml": r3.export_mjcf}

every_robot = pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
every_format = pytest.mark.parametrize("suffix", WRITE)


def states(robot, n=20):
    """Angles, rates and torques at random (n, n_axes)."""
    rng = np.random.default_rng(6)
    ranges = [(-3.0, 3.0), (-4.0, 4.0), (-500.0, 500.0)]  # rad, rad/s, N m
    return [rng.uniform(*ends, (n, robot.n_axes)) for ends in ranges]


# --- programs that read the file -----------------------------------------------------------------


class Pinocchio:
    """By its own ABA; of URDF it has to be told the armatures."""

    def __init__(self, file):
        import pinocchio as pin

        self.pin = pin
        if file.suffix == ".urdf":
            self.model = pin.buildModelFromUrdf(str(file))
            self.model.armature = np.array([armature for armature, _ in joints_in(file)])
        else:
            self.model = pin.buildModelFromMJCF(str(file))
        self.gravity = self.model.gravity.linear
        self.data = self.model.createData()

    def configuration(self, q):
        """A joint without limits is a cosine and a sine in what is read from URDF."""
        return self.pin.integrate(self.model, self.pin.neutral(self.model), q)

    def forward_dynamics(self, q, qd, tau):
        return self.pin.aba(self.model, self.data, self.configuration(q), qd, tau)

    def pose(self, q, name):
        self.pin.framesForwardKinematics(self.model, self.data, self.configuration(q))
        return self.data.oMf[self.model.getFrameId(name)].homogeneous


class MuJoCo:
    """By its smooth dynamics: limits of angles are not enforced here."""

    def __init__(self, file):
        import mujoco

        self.mujoco = mujoco
        spec = mujoco.MjSpec.from_file(str(file))
        spec.compiler.discardvisual = spec.compiler.fusestatic = False
        if file.suffix == ".urdf":
            for joint, (armature, _) in zip(spec.joints, joints_in(file), strict=True):
                joint.armature = armature
        self.model = spec.compile()
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
        self.gravity = self.model.opt.gravity
        self.data = mujoco.MjData(self.model)

    def forward_dynamics(self, q, qd, tau):
        self.data.qpos, self.data.qvel, self.data.qfrc_applied = q, qd, tau
        self.mujoco.mj_forward(self.model, self.data)
        return self.data.qacc.copy()

    def pose(self, q, name):
        self.data.qpos = q
        self.mujoco.mj_kinematics(self.model, self.data)
        is_site = name in [self.model.site(k).name for k in range(self.model.nsite)]
        place = self.data.site(name) if is_site else self.data.body(name)
        return homogeneous(place.xmat.reshape(3, 3), place.xpos)


class Drake:
    """By continuous time; its rotor inertias come from the file."""

    def __init__(self, file):
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.systems.framework import DiagramBuilder

        builder = DiagramBuilder()
        self.plant, self.scene = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        Parser(self.plant).AddModels(str(file))
        self.plant.Finalize()
        self.gravity = self.plant.gravity_field().gravity_vector()
        self.diagram = builder.Build()
        self.context = self.diagram.CreateDefaultContext()
        self.here = self.plant.GetMyMutableContextFromRoot(self.context)
        n = self.plant.num_actuators()
        self.plant.get_actuation_input_port().FixValue(self.here, np.zeros(n))

    def forward_dynamics(self, q, qd, tau):
        self.plant.SetPositions(self.here, q)
        self.plant.SetVelocities(self.here, qd)
        self.plant.get_applied_generalized_force_input_port().FixValue(self.here, tau)
        return self.plant.get_generalized_acceleration_output_port().Eval(self.here)

    def pose(self, q, name):
        self.plant.SetPositions(self.here, q)
        frame = self.plant.GetFrameByName(name)
        return frame.CalcPoseInWorld(self.here).GetAsMatrix4()


PROGRAMS = {"pinocchio": Pinocchio, "mujoco": MuJoCo, "pydrake": Drake}
PACKAGES = {"pinocchio": "pin", "mujoco": "mujoco", "pydrake": "drake"}

every_program = pytest.mark.parametrize("program", PROGRAMS)


def read_by(program, robot, suffix, tmp_path):
    reason = f"{program} is missing: pip install {PACKAGES[program]}"
    pytest.importorskip(program, reason=reason)
    file = tmp_path / f"r3.{suffix}"
    WRITE[suffix](robot, file)
    return PROGRAMS[program](file)


def homogeneous(rotation, position):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, position
    return pose


@every_program
@every_format
@every_robot
def test_it_accelerates_as_ours(program, suffix, robot, tmp_path):
    theirs = read_by(program, robot, suffix, tmp_path)
    for q, qd, tau in zip(*states(robot), strict=True):
        expected = robot.forward_dynamics(q, qd, tau)
        error = np.abs(theirs.forward_dynamics(q, qd, tau) - expected).max()
        assert error <= AGREEMENT * np.abs(expected).max()


@every_program
@every_format
def test_torques_that_balance_gravity_hold_it(program, suffix, tmp_path):
    robot = ROBOTS["load beside axis 6"]
    theirs = read_by(program, robot, suffix, tmp_path)
    np.testing.assert_array_equal(theirs.gravity, [0.0, 0.0, -9.81])
    rest = np.zeros(6)
    for q in states(robot)[0]:
        fall = np.abs(theirs.forward_dynamics(q, rest, rest)).max()
        held = theirs.forward_dynamics(q, rest, robot.inverse_dynamics(q, rest, rest))
        assert fall > 0.1
        assert np.abs(held).max() < AGREEMENT * fall


@pytest.mark.parametrize("program", ["mujoco", "pydrake"])  # Pinocchio does not read it
def test_mjcf_has_the_gravity_of_the_robot(program, tmp_path):
    moon = simplified(table_3={"gravity": 1.62})
    gravity = read_by(program, moon, "xml", tmp_path).gravity
    np.testing.assert_array_equal(gravity, [0.0, 0.0, -1.62])


@every_program
@every_format
@every_robot
def test_links_and_tip_are_where_ours_are(program, suffix, robot, tmp_path):
    theirs = read_by(program, robot, suffix, tmp_path)
    arms = [joint.child for joint in arm_tree(robot).joints]
    for q in states(robot, 5)[0]:
        base, *ours = robot.link_poses(q)
        # Roundoff of lengths up to 2 m.
        np.testing.assert_allclose(theirs.pose(q, "base"), base, atol=1e-14)
        for arm, pose in zip(arms, ours, strict=False):
            np.testing.assert_allclose(theirs.pose(q, arm), pose, atol=1e-14)
        # Of MJCF Drake reads no sites, Pinocchio puts those of fixed bodies in another place.
        reads_site = program == "mujoco" or (program == "pinocchio" and robot.n_axes == 6)
        if len(arms) == 6 and (suffix == "urdf" or reads_site):
            tip = theirs.pose(q, "tip")[:3, 3]
            np.testing.assert_allclose(tip, robot.load_position(q), atol=1e-14)


def test_a_motor_drives_its_joint_by_the_gear_ratio(tmp_path):
    robot = ROBOTS["no load"]
    theirs = read_by("mujoco", robot, "xml", tmp_path)
    motor_torque = np.array([1.0, -2.0, 0.5, 3.0, -0.1, 0.2])
    theirs.data.ctrl = motor_torque
    theirs.forward_dynamics(*np.zeros((3, 6)))
    expected = robot.parameters["table_1"]["p"] * motor_torque
    np.testing.assert_allclose(theirs.data.qfrc_actuator, expected, rtol=1e-15)
    theirs.data.ctrl = 2.0 * np.array(robot.parameters["table_1"]["b"])  # more than there is
    theirs.forward_dynamics(*np.zeros((3, 6)))
    most = np.multiply(robot.parameters["table_1"]["p"], robot.parameters["table_1"]["b"])
    np.testing.assert_allclose(theirs.data.qfrc_actuator, most, rtol=1e-15)


# --- what is in the file -------------------------------------------------------------------------


def floats(text):
    return np.array(text.split(), float)


def symmetric(xx, yy, zz, xy, xz, yz):
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def bodies_in(file):
    """Mass, centre and inertia of what has them, by the name of the link."""
    root = ElementTree.parse(file).getroot()
    found = {}
    for link in root.iter("link" if file.suffix == ".urdf" else "body"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        if file.suffix == ".urdf":
            moments = inertial.find("inertia").attrib
            names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
            tensor = symmetric(*(float(moments[name]) for name in names))
            mass = float(inertial.find("mass").get("value"))
            centre = floats(inertial.find("origin").get("xyz"))
        else:
            tensor = symmetric(*floats(inertial.get("fullinertia")))
            mass, centre = float(inertial.get("mass")), floats(inertial.get("pos"))
        found[link.get("name")] = mass, centre, tensor
    return found


def joints_in(file):
    """Armature and axis of each joint that moves."""
    root = ElementTree.parse(file).getroot()
    if file.suffix == ".xml":
        hinges = root.iter("joint")
        return [(float(hinge.get("armature")), floats(hinge.get("axis"))) for hinge in hinges]
    drake = "{http://drake.mit.edu}"
    motors = {
        transmission.find("joint").get("name"): (
            float(transmission.find(f"actuator/{drake}gear_ratio").get("value")) ** 2
            * float(transmission.find(f"actuator/{drake}rotor_inertia").get("value"))
        )
        for transmission in root.iter("transmission")
    }
    return [
        (motors[joint.get("name")], floats(joint.find("axis").get("xyz")))
        for joint in root.findall("joint")
        if joint.get("type") != "fixed"
    ]


@every_format
@every_robot
def test_the_inertias_in_the_file_have_our_kinetic_energy(suffix, robot, tmp_path):
    file = tmp_path / f"r3.{suffix}"
    WRITE[suffix](robot, file)
    bodies, joints = bodies_in(file), joints_in(file)
    q, qd, _ = states(robot)
    for angle, rate in zip(q, qd, strict=True):
        poses = robot.link_poses(angle)[1:]
        w, origins, axes = np.zeros(3), [], []
        energy = sum(armature * rate[j] ** 2 / 2.0 for j, (armature, _) in enumerate(joints))
        for j, pose in enumerate(poses):
            if j < robot.n_axes:
                origins.append(pose[:3, 3])
                axes.append(rate[j] * (pose[:3, :3] @ joints[j][1]))
                w = w + axes[-1]
            if f"arm_{j + 1}" not in bodies:
                continue
            mass, centre, inertia = bodies[f"arm_{j + 1}"]
            at = pose[:3, :3] @ centre + pose[:3, 3]
            pairs = zip(axes, origins, strict=True)
            v = sum((np.cross(axis, at - origin) for axis, origin in pairs), np.zeros(3))
            w_arm = pose[:3, :3].T @ w
            energy += (mass * v @ v + w_arm @ inertia @ w_arm) / 2.0
        expected = rate @ robot.mass_matrix(angle) @ rate / 2.0
        assert energy == pytest.approx(expected, rel=1e-13)  # measured: 2e-15, roundoff


@every_format
@every_robot
def test_every_body_is_a_rigid_body_with_a_mass(suffix, robot, tmp_path):
    file = tmp_path / f"r3.{suffix}"
    WRITE[suffix](robot, file)
    for mass, _, inertia in bodies_in(file).values():
        a, b, c = np.linalg.eigvalsh(inertia)
        assert mass > 1e-15  # the least that MuJoCo accepts
        assert a > 1e-15
        assert a + b >= c * (1.0 - 1e-12)  # roundoff


def test_limits_of_joints_are_those_of_their_motors(tmp_path):
    robot = ROBOTS["no load"]
    r3.export_urdf(robot, tmp_path / "r3.urdf")
    joints = ElementTree.parse(tmp_path / "r3.urdf").getroot().findall("joint")
    moving = [joint for joint in joints if joint.get("type") != "fixed"]
    limits = [joint.find("limit").attrib for joint in moving]
    # Table 1: 9 N m, 315 to 366 rad/s, gear ratios 60 to 210.
    efforts = [float(limit["effort"]) for limit in limits]
    np.testing.assert_allclose(efforts, [945.0, 1890.0, 540.0, 891.0, 712.8, 891.0], rtol=1e-15)
    rates = [float(limit["velocity"]) for limit in limits]
    expected = [3.0, 1.5, 5.25, 335.0 / 99.0, 335.0 / 79.2, 366.0 / 99.0]
    np.testing.assert_allclose(rates, expected, rtol=1e-15)
    # Table 3; limits of axes 4 to 6 are not known.
    assert [joint.get("type") for joint in moving] == ["revolute"] * 3 + ["continuous"] * 3
    angles = [(float(limit["lower"]), float(limit["upper"])) for limit in limits[:3]]
    assert angles == [(-2.97, 2.97), (-2.01, 2.01), (-2.86, 2.86)]


def test_where_no_limit_is_known_there_is_none(tmp_path):
    r3.export_urdf(ROBOTS["full-robot"], tmp_path / "r3.urdf")
    r3.export_mjcf(ROBOTS["full-robot"], tmp_path / "r3.xml")
    assert "<limit" not in (tmp_path / "r3.urdf").read_text()
    assert "range=" not in (tmp_path / "r3.xml").read_text()


@every_format
def test_names_are_those_of_arms_and_axes(suffix, tmp_path):
    WRITE[suffix](ROBOTS["no load"], tmp_path / "r3")
    root = ElementTree.parse(tmp_path / "r3").getroot()
    named = {element.get("name") for element in root.iter()}
    expected = {f"{what}_{k}" for what in ("joint", "arm", "motor") for k in range(1, 7)}
    assert expected | {"base", "tip"} <= named


# --- what it does not say ------------------------------------------------------------------------


def comment_in(file):
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    (comment,) = ElementTree.parse(file, parser).getroot().iter(ElementTree.Comment)
    return [line.strip().removeprefix("* ") for line in comment.text.strip().splitlines()]


@every_format
@every_robot
def test_remarks_are_returned_and_are_a_comment_in_the_file(suffix, robot, tmp_path, capsys):
    remarks = WRITE[suffix](robot, tmp_path / "r3")
    title, *lines = comment_in(tmp_path / "r3")
    assert title == f"{robot.title}, written by manutec_r3."
    assert tuple(lines) == remarks
    assert capsys.readouterr() == ("", "")


def test_remarks_are_about_this_robot(tmp_path):
    def remarks(suffix, robot):
        return " ".join(WRITE[suffix](robot, tmp_path / "r3"))

    plain = remarks("urdf", ROBOTS["no load"])
    assert "gravity: 9.81 m/s^2" in plain
    # p^2 rJ
    assert "14.3325, 57.33, 4.68, 1.56816, 1.1290752, 0.421443 kg m^2" in plain
    assert "Arm 6 has no mass" in plain
    assert "spin" not in plain
    assert "spin" in remarks("xml", r3.Robot(model=1))
    assert "limits of joint rates: 3, 1.5, 5.25, 3.384, 4.23, 3.697 rad/s" in remarks(
        "xml", r3.Robot(model=1)
    )
    assert "Arm 6 has no inertia about some axis" in remarks("xml", ROBOTS["load on axis 6"])
    assert "Arm 5 has lent arm 6 0.005 kg m^2" in remarks("xml", ROBOTS["I33 of arm 6 known"])
    assert "Joints 4 to 6 are fixed" in remarks("xml", ROBOTS["three arms"])
    assert "since no limit is known: 4, 5, 6" in plain
    flat = {"arms": {6: {"mass": 1.0, "I11": 0.1, "I22": 0.2, "I33": 0.3}}}
    assert "lent" not in remarks("xml", simplified(table_3=flat))
    complete = {
        "arms": {
            1: {"mass": 30.0, "I11": 1.2, "I22": 1.2},
            6: {"mass": 1.0, "I11": 0.01, "I22": 0.01, "I33": 0.01},
        }
    }
    known = remarks("xml", simplified(table_3=complete))
    assert "made up" not in known
    assert "stand in" not in known


# --- shapes --------------------------------------------------------------------------------------


def shapes_in_the_world(robot, q):
    """Kind, middle and rotation of each shape of each link."""
    for link, pose in zip(arm_tree(robot).links, robot.link_poses(q), strict=False):
        for shape in link.shapes:
            middle = pose[:3, :3] @ shape.position + pose[:3, 3]
            yield shape.kind, middle, pose[:3, :3] @ shape.rotation


with_and_without_a_tip = pytest.mark.parametrize(
    "robot", [ROBOTS["load beside axis 6"], ROBOTS["one-axis"]], ids=["six arms", "one"]
)
SIX_DIGITS = 2e-5  # are written, of lengths and angles; measured: 8e-6


@with_and_without_a_tip
def test_shapes_follow_their_links_in_mujoco(robot, tmp_path):
    theirs = read_by("mujoco", robot, "xml", tmp_path)
    data, geom = theirs.data, theirs.mujoco.mjtGeom
    kinds = {"box": geom.mjGEOM_BOX, "cylinder": geom.mjGEOM_CYLINDER, "sphere": geom.mjGEOM_SPHERE}
    for q in states(robot, 3)[0]:
        data.qpos = q
        theirs.mujoco.mj_kinematics(theirs.model, data)
        ours = list(shapes_in_the_world(robot, q))
        assert [int(kinds[kind]) for kind, _, _ in ours] == theirs.model.geom_type.tolist()
        np.testing.assert_allclose(data.geom_xpos, [at for _, at, _ in ours], atol=SIX_DIGITS)
        turned = data.geom_xmat.reshape(-1, 3, 3)
        np.testing.assert_allclose(turned, [r for _, _, r in ours], atol=SIX_DIGITS)


@with_and_without_a_tip
def test_shapes_follow_their_links_in_pinocchio(robot, tmp_path):
    theirs = read_by("pinocchio", robot, "urdf", tmp_path)
    pin, file = theirs.pin, str(tmp_path / "r3.urdf")
    seen = pin.buildGeomFromUrdf(theirs.model, file, pin.GeometryType.VISUAL)
    kinds = {"box": "Box", "cylinder": "Cylinder", "sphere": "Sphere"}
    for q in states(robot, 3)[0]:
        ours = list(shapes_in_the_world(robot, q))
        pin.forwardKinematics(theirs.model, theirs.data, theirs.configuration(q))
        for shape, (kind, at, rotation) in zip(seen.geometryObjects, ours, strict=True):
            place = theirs.data.oMi[shape.parentJoint] * shape.placement
            assert type(shape.geometry).__name__ == kinds[kind]
            np.testing.assert_allclose(place.translation, at, atol=SIX_DIGITS)
            np.testing.assert_allclose(place.rotation, rotation, atol=SIX_DIGITS)


@every_format
def test_drake_sees_all_shapes(suffix, tmp_path):
    robot = ROBOTS["load on axis 6"]
    drake = read_by("pydrake", robot, suffix, tmp_path)
    n = sum(len(link.shapes) for link in arm_tree(robot).links)
    assert drake.scene.model_inspector().num_geometries() == n


@every_robot
def test_shapes_reach_as_far_as_those_of_the_animation(robot):
    pytest.importorskip("trimesh", reason='trimesh is missing: pip install "manutec-r3[animation]"')
    import trimesh

    from manutec_r3.animation import meshes

    made = meshes.arms(robot)
    for link in arm_tree(robot).links:
        parts = made[link.name] + (made.get("load", []) if link.name == "arm_6" else [])
        expected = np.stack([mesh.bounds for _, mesh in parts])
        bounds = []
        for shape in link.shapes:
            assert shape.material in MATERIALS
            make = {
                "box": trimesh.creation.box,
                "cylinder": trimesh.creation.cylinder,
                "sphere": trimesh.creation.icosphere,
            }[shape.kind]
            names = {"box": ["extents"], "cylinder": ["radius", "height"], "sphere": ["radius"]}
            size = [shape.size] if shape.kind == "box" else shape.size
            mesh = make(**dict(zip(names[shape.kind], size, strict=True)))
            bounds.append(mesh.apply_transform(homogeneous(shape.rotation, shape.position)).bounds)
        bounds = np.stack(bounds)
        # Corners of bars stand out of the hull, by at most 5.3 mm.
        lowest, highest = expected[:, 0].min(axis=0), expected[:, 1].max(axis=0)
        np.testing.assert_allclose(bounds[:, 0].min(axis=0), lowest, atol=0.01)
        np.testing.assert_allclose(bounds[:, 1].max(axis=0), highest, atol=0.01)


# --- wrong input ---------------------------------------------------------------------------------


@pytest.mark.parametrize("write", WRITE.values())
@pytest.mark.parametrize(
    ("robot", "path", "error", "message"),
    [
        ("figure9", "r3", TypeError, "robot: expected a Robot, got 'figure9'"),
        (ROBOTS["no load"], 3, TypeError, "path: expected a name of a file, got 3"),
        (
            simplified(table_3={"arms": {6: {"I33": 0.5}}}),
            "r3",
            ValueError,
            r"table_3 arms of arm 5: expected the inertia of a rigid body.*got I11.*-0.2375",
        ),
        (
            simplified(table_3={"arms": {5: {"I11": 0.0, "I22": 0.0, "I33": 0.1}}}),
            "r3",
            ValueError,
            r"table_3 arms of arm 5: expected the inertia of a rigid body.*got I11.* 0, 0, 0.1",
        ),
    ],
)
def test_wrong_input_is_refused(write, robot, path, error, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message):
        write(robot, path)
    assert list(tmp_path.iterdir()) == []


# --- on the command line -------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "suffix"), [("urdf", "urdf"), ("mjcf", "xml")])
def test_the_command_writes_the_file_and_prints_what_it_does_not_say(name, suffix, tmp_path):
    command = [sys.executable, "-m", "manutec_r3", "export", name, "figure9"]
    with child(*command, "-o", "r3.xml", cwd=tmp_path) as process:
        out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    first, *remarks = out.splitlines()
    assert first == "wrote r3.xml"
    assert [line.removeprefix("* ") for line in remarks] == comment_in(tmp_path / "r3.xml")[1:]
    WRITE[suffix](r3.Scenario.load("figure9").robot, tmp_path / "ours.xml")
    assert (tmp_path / "r3.xml").read_bytes() == (tmp_path / "ours.xml").read_bytes()


def test_the_command_prints_json_for_machines(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["export", "mjcf", "one-axis", "--json"])
    told = json.loads(done.stdout)
    assert told["file"] == "one-axis.xml"
    assert told["remarks"] == comment_in(tmp_path / "one-axis.xml")[1:]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["urdf", "figure10"], "no scenario 'figure10'"),
        (["mjcf", "figure9", "-o", "no/folder.xml"], "no/folder.xml: No such file or directory"),
    ],
)
def test_the_command_ends_with_what_is_wrong(arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["export", *arguments])
    assert done.exit_code == 2
    assert message in done.stderr
