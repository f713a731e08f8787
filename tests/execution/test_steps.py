"""Steps for controllers: played back, they are the trace."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from domains.tabletop.scene.worlds import find_world
from runtime.export.as_json import steps_to_json
from runtime.export.goals import joint_track
from runtime.export.messages import track_of
from runtime.export.moveit import moveit
from runtime.export.steps import steps_of
from runtime.robot.controllers import controller, misfits, proposed_controllers, unmoved
from runtime.robot.load import load_robot
from runtime.trace.kinematics import Tree, links_at
from runtime.trace.load import load_trace
from runtime.trace.model import Trace
from runtime.trace.read import trace_of
from runtime.trace.track import TrackBuilder
from runtime.trace.write import dumps
from sketchlang.cli import cli
from sketchlang.errors import InputError

PLANS = {
    "franka_mobile": ("sorting/3t-02", "holonomic base, fingers that mimic"),
    "ur5e_desk": ("desk/low", "fixed base, a fitted gripper"),
}


@pytest.fixture(scope="module", params=["trace", "in_turn", *PLANS])
def planned(request, tmp_path_factory) -> Trace:
    """A plan of each built-in robot."""
    if request.param not in PLANS:
        return request.getfixturevalue(request.param)
    path = tmp_path_factory.mktemp("steps") / "plan.json"
    words = ["run", "pick_and_place", PLANS[request.param][0], "--robot", request.param]
    done = CliRunner().invoke(cli, [*words, "--out", str(path)])
    assert done.exit_code == 0, done.output
    return load_trace(path, find_world)


class Player:
    """Carries out messages as controllers do, and knows nothing else of the plan."""

    def __init__(self, trace: Trace) -> None:
        self.robot, self.tree = trace.robot, Tree(trace.robot)
        self.base = trace.base.values[0]
        self.values = dict(zip(trace.robot.joints, trace.joints.values[0].tolist(), strict=True))
        opened = trace.robot.finger_values(trace.opening.values[0, 0])
        self.values |= dict(zip(trace.robot.fingers, opened.tolist(), strict=True))

    def play(self, step: dict, times: np.ndarray) -> list[dict[str, np.ndarray]]:
        """World poses of all links at times of a step."""
        values = {name: np.full(len(times), value) for name, value in self.values.items()}
        bases = np.repeat(self.base[None], len(times), axis=0)
        for goal in step["goals"]:
            message = goal["goal"]
            if "path" in message:
                bases = self._along(message["path"], times)
                continue
            track = track_of(message["trajectory"])
            found = track.at(times)[0]
            values |= dict(zip(message["trajectory"]["joint_names"], found.T, strict=True))
        self.base = bases[-1]
        self.values = {name: float(row[-1]) for name, row in values.items()}
        return [
            self.tree.links(
                bases[i],
                np.array([values[name][i] for name in self.robot.joints]),
                self._opening({name: row[i] for name, row in values.items()}),
            )
            for i in range(len(times))
        ]

    def _opening(self, values: dict[str, float]) -> float:
        """From a finger that is moved: others may mimic it."""
        named = {name for each in self.robot.controllers for name in each.joints}
        i, name = next((i, n) for i, n in enumerate(self.robot.fingers) if n in named)
        column, openings = self.robot.finger_table[:, i], self.robot.openings
        if column[-1] < column[0]:
            column, openings = column[::-1], openings[::-1]
        return float(np.interp(values[name], column, openings))

    @staticmethod
    def _along(path: dict, times: np.ndarray) -> np.ndarray:
        stamps = [p["header"]["stamp"] for p in path["poses"]]
        marks = np.array([s["sec"] + s["nanosec"] * 1e-9 for s in stamps])
        places = [p["pose"] for p in path["poses"]]
        turns = [2 * np.arctan2(p["orientation"]["z"], p["orientation"]["w"]) for p in places]
        columns = (
            [p["position"]["x"] for p in places],
            [p["position"]["y"] for p in places],
            np.unwrap(turns),
        )
        return np.stack([np.interp(times, marks, column) for column in columns], axis=1)


def test_played_back_steps_are_the_trace_within_a_millimetre(planned) -> None:
    """All links, ten times a second, from the messages alone; and nothing moves in between."""
    steps = json.loads(json.dumps(steps_to_json(planned, steps_of(planned), "map")))["steps"]
    player, tree = Player(planned), Tree(planned.robot)
    worst = 0.0
    for step, following in zip(steps, [*steps[1:], {"start": planned.duration}], strict=True):
        times = np.append(np.arange(0.0, step["duration"], 0.1), step["duration"])
        played = player.play(step, times)
        planned_poses = [links_at(planned, tree, step["start"] + t) for t in times.tolist()]
        # Until the next step everything stays where it is.
        played.append(played[-1])
        planned_poses.append(links_at(planned, tree, following["start"]))
        for ours, wanted in zip(played, planned_poses, strict=True):
            worst = max(worst, *(np.linalg.norm(ours[n][:3, 3] - wanted[n][:3, 3]) for n in wanted))
    assert worst < 1e-3, worst


def test_each_message_names_the_joints_of_its_controller(planned) -> None:
    joints = {each.name: list(each.joints) for each in planned.robot.controllers}
    seen = set()
    for step in steps_to_json(planned, steps_of(planned), "map")["steps"]:
        assert step["goals"]
        for goal in step["goals"]:
            seen.add(goal["controller"])
            if goal["type"].endswith("FollowJointTrajectory"):
                trajectory = goal["goal"]["trajectory"]
                assert trajectory["joint_names"] == joints[goal["controller"]]
                assert all(
                    len(point["positions"])
                    == len(point["velocities"])
                    == len(joints[goal["controller"]])
                    for point in trajectory["points"]
                )
                ends = [trajectory["points"][i]["velocities"] for i in (0, -1)]
                assert not np.any(ends)
    assert seen == set(joints)


def test_every_grip_ends_a_step(planned) -> None:
    grips = [step.grip for step in steps_of(planned) if step.grip is not None]
    assert grips == list(planned.grips)
    for step in steps_of(planned):
        assert step.grip is None or step.end == pytest.approx(step.grip.time)


def test_in_turn_the_base_moves_alone(trace, in_turn) -> None:
    alone = [
        {goal.controller.moves_base for goal in step.goals} != {True, False}
        for each in (trace, in_turn)
        for step in steps_of(each)
    ]
    assert all(alone[len(steps_of(trace)) :])
    assert not all(alone)
    assert [a.text for a in in_turn.actions] == [a.text for a in trace.actions]


def test_base_and_arm_that_move_at_once_are_one_step(in_turn) -> None:
    """What overlaps follows from the trace, not from what the planner does."""
    trace = in_turn
    first = steps_of(trace)[0]
    builder = TrackBuilder(trace.joints.values[0])
    moved = trace.joints.values[0] + 0.1
    builder.line(0.5 * first.end, first.end - 0.1, moved, 0.3)
    builder.line(first.end + 0.2, first.end + 0.4, trace.joints.values[0], 0.3)
    both = replace(trace, joints=builder.track(), duration=first.end + 0.4, grips=())
    still = TrackBuilder(trace.opening.values[0])
    steps = steps_of(replace(both, opening=still.track(), base=_until(trace.base, first.end)))
    names = [[goal.controller.name for goal in step.goals] for step in steps]
    # Before the arm begins, the base rests once: it turns, then it drives.
    assert names == [
        ["base"],
        ["torso_controller", "arm_controller", "base"],
        ["torso_controller", "arm_controller"],
    ]
    assert [step.untimed for step in steps] == [None, "base", None]
    ends = [goal.motion.times[-1] for goal in steps[1].goals]
    assert ends == pytest.approx([steps[1].duration] * 3)


def test_a_base_may_keep_times(trace) -> None:
    """As three joints, whose values are those of the trace, whatever moves with it."""
    kept = [c for c in trace.robot.controllers if not c.moves_base]
    wheels = controller("wheels", "FollowJointTrajectory", ["x", "y", "t"], base=True)
    robot = replace(trace.robot, controllers=(*kept, wheels))
    steps = steps_of(replace(trace, robot=robot))
    drives = [(s, g) for s in steps for g in s.goals if g.controller == wheels]
    assert len(drives) > 2
    assert any(len(step.goals) > 1 for step, _ in drives)
    assert not any(step.untimed for step in steps)
    for step, goal in drives:
        assert goal.message["trajectory"]["joint_names"] == ["x", "y", "t"]
        times = np.linspace(0, step.duration, 50)
        wanted = trace.base.at(step.start + times)[0]
        assert track_of(goal.message["trajectory"]).at(times)[0] == pytest.approx(wanted, abs=1e-5)
    assert list(misfits(robot.controllers, [*robot.joints, *robot.fingers])) == []


def test_a_step_has_all_the_actions_between_two_rests(trace) -> None:
    """One motion over the end of an action: the arm is still on its way when the next begins."""
    first, second = trace.actions[0], trace.actions[1]
    joints = TrackBuilder(trace.joints.values[0])
    joints.line(first.end - 0.5, second.start + 0.5, trace.joints.values[0] + 0.1, 0.3)
    still = TrackBuilder(trace.opening.values[0]).track()
    base = TrackBuilder(trace.base.values[0]).track()
    moved = replace(trace, joints=joints.track(), opening=still, base=base, grips=())
    (step,) = steps_of(moved)
    assert step.actions == (0, 1)
    assert step.text == f"{first.text}; {second.text}"


def test_a_grasp_ends_a_step_though_the_fingers_go_on(trace) -> None:
    builder = TrackBuilder(trace.opening.values[0])
    builder.line(0.0, 0.5, trace.opening.values[0] / 2, 0.3)
    builder.line(0.5, 1.0, trace.opening.values[0], 0.3)
    still = replace(
        trace,
        duration=1.0,
        opening=builder.track(),
        joints=TrackBuilder(trace.joints.values[0]).track(),
        base=TrackBuilder(trace.base.values[0]).track(),
        grips=(replace(trace.grips[0], start=0.0, time=0.5),),
    )
    steps = steps_of(still)
    assert [(step.end, step.grip is None) for step in steps] == [(0.5, False), (1.0, True)]


def _until(track, end):
    kept = track.times <= end + 1e-9
    return replace(
        track,
        times=track.times[kept],
        values=track.values[kept],
        velocities=track.velocities[kept],
    )


def test_a_trace_file_keeps_its_controllers(trace) -> None:
    from runtime.plan.node import Node

    again = trace_of(Node(json.loads(dumps(trace)), "trace.json"))
    assert again.robot.controllers == trace.robot.controllers


def test_what_is_measured_is_not_sent(trace) -> None:
    with pytest.raises(InputError, match="measured"):
        steps_of(replace(trace, source="execution"))


def test_a_joint_without_a_controller_is_named(trace) -> None:
    some = tuple(c for c in trace.robot.controllers if c.name != "torso_controller")
    with pytest.raises(InputError, match="torso_lift_joint"):
        steps_of(replace(trace, robot=replace(trace.robot, controllers=some)))


def test_a_gripper_may_take_commands_instead(trace) -> None:
    kept = [c for c in trace.robot.controllers if c.name != "gripper_controller"]
    gripper = controller("hand", "GripperCommand", trace.robot.fingers[:1], "/hand/gripper")
    robot = replace(trace.robot, controllers=(*kept, gripper))
    goals = [g for s in steps_of(replace(trace, robot=robot)) for g in s.goals]
    commands = [g.message["command"]["position"] for g in goals if g.controller == gripper]
    openings = [trace.opening.at(np.array([grip.time]))[0][0, 0] for grip in trace.grips]
    fingers = [trace.robot.finger_values(np.array(o))[0] for o in openings]
    assert set(np.round(fingers, 6)) <= set(commands)


MOVEIT = {
    "moveit_msgs/msg/RobotState": """
        sensor_msgs/JointState joint_state
        sensor_msgs/MultiDOFJointState multi_dof_joint_state
        moveit_msgs/AttachedCollisionObject[] attached_collision_objects
        bool is_diff""",
    "moveit_msgs/msg/CollisionObject": """
        std_msgs/Header header
        geometry_msgs/Pose pose
        string id
        shape_msgs/SolidPrimitive[] primitives
        geometry_msgs/Pose[] primitive_poses
        shape_msgs/Mesh[] meshes
        geometry_msgs/Pose[] mesh_poses
        byte operation""",
    "moveit_msgs/msg/AttachedCollisionObject": """
        string link_name
        moveit_msgs/CollisionObject object
        string[] touch_links
        trajectory_msgs/JointTrajectory detach_posture
        float64 weight""",
    "moveit_msgs/msg/PlanningSceneWorld": "moveit_msgs/CollisionObject[] collision_objects",
    "moveit_msgs/msg/PlanningScene": """
        string name
        moveit_msgs/RobotState robot_state
        string robot_model_name
        moveit_msgs/PlanningSceneWorld world
        bool is_diff""",
    "moveit_msgs/msg/RobotTrajectory": """
        trajectory_msgs/JointTrajectory joint_trajectory
        trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory""",
    "control_msgs/action/FollowJointTrajectory": "trajectory_msgs/JointTrajectory trajectory",
    "nav2_msgs/action/FollowPath": """
        nav_msgs/Path path
        string controller_id
        string goal_checker_id""",
}
"""The definitions as far as they are used: a message with a field that is not here is wrong."""


@pytest.fixture(scope="module")
def store():
    pytest.importorskip("rosbags")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    found = get_typestore(Stores.ROS2_HUMBLE)
    types: dict = {}
    for name, text in MOVEIT.items():
        lines = "\n".join(line.strip() for line in text.strip().splitlines())
        types |= get_types_from_msg(lines, name)
    found.register(types)
    return found


def test_messages_have_the_fields_of_their_definitions(planned, store) -> None:
    from runtime.export.typed import typed

    steps = steps_of(planned)
    for step in steps:
        for goal in step.goals:
            store.serialize_cdr(typed(store, goal.type, goal.message), goal.type)
    data = moveit(planned, steps)
    scene = "moveit_msgs/msg/PlanningScene"
    store.serialize_cdr(typed(store, scene, data["planning_scene"]), scene)
    for step in data["steps"]:
        kind = "moveit_msgs/msg/RobotTrajectory"
        store.serialize_cdr(typed(store, kind, step["trajectory"]), kind)
        for diff in step["scene_diffs"]:
            store.serialize_cdr(typed(store, scene, diff), scene)


def test_the_planning_scene_ends_as_the_trace_does(planned) -> None:
    """All that is attached is detached where the trace puts it."""
    data = moveit(planned, steps_of(planned))
    where = {o["id"]: o["pose"] for o in data["planning_scene"]["world"]["collision_objects"]}
    held: dict[str, str] = {}
    for step in data["steps"]:
        for diff in step["scene_diffs"]:
            for attached in diff["robot_state"]["attached_collision_objects"]:
                name = attached["object"]["id"]
                if attached["object"]["operation"] == 0:
                    held[name] = attached["link_name"]
                else:
                    assert held.pop(name) == attached["link_name"]
            for each in diff["world"]["collision_objects"]:
                if each["operation"] == 1:
                    del where[each["id"]]
                else:
                    where[each["id"]] = each["pose"]
    assert held == {}
    for index, thing in enumerate(planned.world.movables):
        last = planned.span(index, planned.duration).at(planned.duration)
        found = where[thing.name]["position"]
        assert [found[k] for k in "xyz"] == pytest.approx(last[:3], abs=1e-5)


def test_export_writes_both(plan_file, tmp_path) -> None:
    outputs = [tmp_path / name for name in ("steps.json", "moveit.json")]
    words = ["export", str(plan_file), "--steps", str(outputs[0]), "--moveit", str(outputs[1])]
    done = CliRunner().invoke(cli, [*words, "--frame", "odom"])
    assert done.exit_code == 0, done.output
    steps, scene = (json.loads(Path(path).read_text()) for path in outputs)
    assert steps["frame"] == "odom"
    assert len(steps["steps"]) == len(scene["steps"])
    assert scene["planning_scene"]["world"]["collision_objects"][0]["header"]["frame_id"] == "odom"


def test_the_built_in_robots_have_a_controller_for_everything_that_moves() -> None:
    for name in ("tiago", "franka_mobile", "ur5e_desk"):
        robot = load_robot(name)
        assert list(unmoved(robot.controllers, robot.joints, robot.base.type != "fixed")) == []
    tiago = {each.name: each.joints for each in load_robot("tiago").controllers}
    assert tiago["torso_controller"] == ("torso_lift_joint",)
    assert tiago["arm_controller"] == tuple(f"arm_{i}_joint" for i in range(1, 8))


def test_what_slides_below_the_arm_is_the_torso() -> None:
    joints = list(load_robot("tiago").urdf.chain("gripper_grasping_frame"))
    moving = [joint for joint in joints if joint.type != "fixed"]
    names = [each.name for each in proposed_controllers(moving, ["f"], mobile=False)]
    assert names == ["torso_controller", "arm_controller", "gripper_controller"]
    names = [each.name for each in proposed_controllers(moving[1:], [], mobile=True)]
    assert names == ["arm_controller", "base"]


def test_controllers_that_do_not_fit_are_found() -> None:
    follow = "FollowJointTrajectory"
    those = [
        controller("a", follow, ["j1", "j2"]),
        controller("b", follow, ["j2", "j9"]),
        controller("c", "FollowPath"),
        controller("d", "NavigateToPose"),
    ]
    found = [(name, message) for name, message, _ in misfits(those, ["j1", "j2"])]
    assert [name for name, _ in found] == ["b", "b", "d"]
    assert "j9" in found[1][1]


def test_fingers_that_turn_follow_the_opening(trace) -> None:
    """Their values are no cubic where the opening is one: knots in between make up for it."""
    openings = np.linspace(0.0, trace.robot.max_opening, 33)
    turned = np.arcsin(np.clip(openings / 0.1, -1, 1))
    robot = replace(
        trace.robot, openings=openings, finger_table=np.stack([turned, -turned], axis=1)
    )
    turning = replace(trace, robot=robot)
    times = np.linspace(0.0, trace.duration, 20_000)
    wanted = robot.finger_values(trace.opening.at(times)[0][:, 0])[:, 0]
    found = joint_track(turning, robot.fingers[0]).at(times)[0][:, 0]
    # Radians; fingers are some 5 cm long.
    assert found == pytest.approx(wanted, abs=5e-4)
