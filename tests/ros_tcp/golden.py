#!/usr/bin/env python3
"""Writes golden.txt for messages_test.cpp: the bytes of messages as ROS itself writes them.

For ROS 1, it uses Debian's message classes (python3-std-msgs, python3-sensor-msgs,
python3-geometry-msgs, python3-visualization-msgs). For ROS 2, it uses PyPI's rosbags 0.11.9 (types of
Humble). The tests need neither of them. Run it with a Python that finds both:
`python3 golden.py > golden.txt`.
"""
import io
import sys

import numpy as np
from geometry_msgs.msg import Point, PoseStamped, WrenchStamped
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64MultiArray, MultiArrayDimension, String
from visualization_msgs.msg import Marker

STORE = get_typestore(Stores.ROS2_HUMBLE)
T = STORE.types
POSE = (0.25, -1.5, 3.0, 0.5, -0.5, 0.5, 0.5)  # x y z, quaternion x y z w
POINTS = [(0.0, 1.0, 2.0), (3.0, 4.0, 5.5)]


def write(name, ros1, ros2, ros2_type):
    out = io.BytesIO()
    ros1.serialize(out)
    print(name, 'ROS1', out.getvalue().hex())
    print(name, 'ROS2', bytes(STORE.serialize_cdr(ros2, ros2_type)).hex())


def header1(message):
    message.header.seq = 7
    message.header.stamp.secs, message.header.stamp.nsecs = 12, 345
    message.header.frame_id = 'world'
    return message


def header2(frame='world', sec=12, nanosec=345):
    time = T['builtin_interfaces/msg/Time'](sec=sec, nanosec=nanosec)
    return T['std_msgs/msg/Header'](stamp=time, frame_id=frame)


def vector2(kind, xyz):
    return T[f'geometry_msgs/msg/{kind}'](x=xyz[0], y=xyz[1], z=xyz[2])


def pose2():
    x, y, z, *q = POSE
    rotation = T['geometry_msgs/msg/Quaternion'](x=q[0], y=q[1], z=q[2], w=q[3])
    return T['geometry_msgs/msg/Pose'](position=vector2('Point', (x, y, z)), orientation=rotation)


def set_pose1(pose):
    p, q = pose.position, pose.orientation
    p.x, p.y, p.z, q.x, q.y, q.z, q.w = POSE


def strings():
    for text in ('', 'RUN', 'HELD force left 30.1 30'):
        yield String(data=text), T['std_msgs/msg/String'](data=text)


for index, (one, two) in enumerate(strings()):
    write(f'string{index}', one, two, 'std_msgs/msg/String')
for name, value in (('stop', True), ('no_stop', False)):
    write(name, Bool(data=value), T['std_msgs/msg/Bool'](data=value), 'std_msgs/msg/Bool')

for count in (0, 1, 2, 3):
    names = [f'joint{"x" * k}' for k in range(count)]
    values = [0.5 * k - 0.25 for k in range(count)]
    efforts = [8.0 * k - 1.5 for k in range(count)]
    one = header1(JointState(name=names, position=values, velocity=values, effort=efforts))
    two = T['sensor_msgs/msg/JointState'](
        header=header2(), name=names, position=np.array(values), velocity=np.array(values),
        effort=np.array(efforts))
    write(f'joints{count}', one, two, 'sensor_msgs/msg/JointState')

one = header1(PoseStamped())
set_pose1(one.pose)
write('pose', one, T['geometry_msgs/msg/PoseStamped'](header=header2(), pose=pose2()),
     'geometry_msgs/msg/PoseStamped')

one = header1(WrenchStamped())
for part, values in ((one.wrench.force, (1, 2, 3)), (one.wrench.torque, (-4, 5.5, 0.125))):
    part.x, part.y, part.z = values
two = T['geometry_msgs/msg/WrenchStamped'](header=header2(), wrench=T['geometry_msgs/msg/Wrench'](
    force=vector2('Vector3', (1.0, 2.0, 3.0)), torque=vector2('Vector3', (-4.0, 5.5, 0.125))))
write('wrench', one, two, 'geometry_msgs/msg/WrenchStamped')

one = Float64MultiArray(data=[0.001, 0.002])
one.layout.dim = [MultiArrayDimension(label='left, right', size=2, stride=2)]
two = T['std_msgs/msg/Float64MultiArray'](
    layout=T['std_msgs/msg/MultiArrayLayout'](
        dim=[T['std_msgs/msg/MultiArrayDimension'](label='left, right', size=2, stride=2)],
        data_offset=0), data=np.array([0.001, 0.002]))
write('array', one, two, 'std_msgs/msg/Float64MultiArray')

ARROW, LINE_STRIP = Marker.ARROW, Marker.LINE_STRIP
MARKERS = (('arrow', ARROW, '', POINTS), ('line', LINE_STRIP, '', POINTS),
           ('words', LINE_STRIP, 'red', []), ('odd', LINE_STRIP, 'ab', POINTS[:1]))
for name, kind, text, points in MARKERS:
    one = header1(Marker(ns='force' + text, id=1, type=kind, action=Marker.ADD, text=text))
    set_pose1(one.pose)
    one.scale.x, one.scale.y, one.scale.z = 0.01, 0.02, 0.0
    one.color.r, one.color.g, one.color.b, one.color.a = 0.5, 0.25, 0.75, 1.0
    one.points = [Point(*p) for p in points]
    two = T['visualization_msgs/msg/Marker'](
        header=header2(), ns='force' + text, id=1, type=kind, action=0, pose=pose2(),
        scale=vector2('Vector3', (0.01, 0.02, 0.0)),
        color=T['std_msgs/msg/ColorRGBA'](r=0.5, g=0.25, b=0.75, a=1.0),
        lifetime=T['builtin_interfaces/msg/Duration'](sec=0, nanosec=0), frame_locked=False,
        points=[vector2('Point', p) for p in points], colors=[], texture_resource='',
        texture=T['sensor_msgs/msg/CompressedImage'](
            header=header2('', 0, 0), format='', data=np.array([], dtype=np.uint8)),
        uv_coordinates=[], text=text, mesh_resource='',
        mesh_file=T['visualization_msgs/msg/MeshFile'](
            filename='', data=np.array([], dtype=np.uint8)),
        mesh_use_embedded_materials=False)
    write(name, one, two, 'visualization_msgs/msg/Marker')
sys.stdout.flush()
