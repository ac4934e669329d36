#!/usr/bin/python3
"""read_bag.py BAG...: reads every message of each bag with Debian's python3-rosbag and prints one JSON line a bag.

The message classes are made from the definitions that stand in the bag, so nothing of ours takes part in the reading.
"""
import contextlib
import hashlib
import io
import json
import sys

import rosbag
from rosbag import rosbag_main


def md5(data):
    return hashlib.md5(bytes(data)).hexdigest()


def header(message):
    return {"stamp_us": message.header.stamp.to_nsec() // 1000, "frame": message.header.frame_id}


def numbers(values):
    return [float(value) for value in values]


def point(p):
    return [p.x, p.y, p.z]


def pose(p):
    q = p.orientation
    return point(p.position) + [q.x, q.y, q.z, q.w]


def marker(m):
    return {**header(m), "ns": m.ns, "id": m.id, "type": m.type, "action": m.action, "scale": point(m.scale),
            "points": [point(p) for p in m.points],
            "colors": [[c.r, c.g, c.b, c.a] for c in m.colors], "pose": pose(m.pose)}


def describe(type_name, m):
    name = type_name.split("/")[1]
    if name == "Image":
        return {**header(m), "size": [m.width, m.height], "step": m.step, "encoding": m.encoding, "md5": md5(m.data)}
    if name == "CompressedImage":
        return {**header(m), "format": m.format, "md5": md5(m.data)}
    if name == "CameraInfo":
        return {**header(m), "size": [m.width, m.height], "model": m.distortion_model, "D": numbers(m.D),
                "K": numbers(m.K), "P": numbers(m.P)}
    if name == "JointState":
        return {**header(m), "names": list(m.name), "positions": numbers(m.position)}
    if name == "Odometry":
        return {**header(m), "child": m.child_frame_id, "pose": pose(m.pose.pose), "v": m.twist.twist.linear.x,
                "w": m.twist.twist.angular.z}
    if name == "PoseWithCovarianceStamped":
        return {**header(m), "pose": pose(m.pose.pose), "covariance": numbers(m.pose.covariance)}
    if name == "TFMessage":
        return [{**header(t), "child": t.child_frame_id, "translation": point(t.transform.translation),
                 "rotation": [t.transform.rotation.x, t.transform.rotation.y, t.transform.rotation.z,
                              t.transform.rotation.w]} for t in m.transforms]
    if name == "MarkerArray":
        return [marker(item) for item in m.markers]
    if name == "String":
        return m.data
    raise ValueError("a type that no recording of ours has: " + type_name)


def read(path):
    info = io.StringIO()
    with contextlib.redirect_stdout(info):
        rosbag_main.rosbagmain(["rosbag", "info", path])
    topics = {}
    with rosbag.Bag(path) as bag:
        types = {topic: entry.msg_type for topic, entry in bag.get_type_and_topic_info().topics.items()}
        for topic, message, time in bag.read_messages():
            topics.setdefault(topic, []).append({"recorded_ns": time.to_nsec(),
                                                 "message": describe(types[topic], message)})
    return {"file": path, "info": info.getvalue(), "topics": topics}


for name in sys.argv[1:]:
    print(json.dumps(read(name)))
