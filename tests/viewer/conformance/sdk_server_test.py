"""Compares the channels and frames of Foxglove's own server with ours, as seen by a raw `foxglove.sdk.v1` client."""

import base64
import contextlib
import json
import os
import unittest

import foxglove
from foxglove.channels import FrameTransformsChannel, JointStatesChannel, SceneUpdateChannel
from google.protobuf import descriptor_pb2, descriptor_pool, json_format, message_factory
from google.protobuf.descriptor import FieldDescriptor

from program import Predictor
from raw_client import RawClient

SDK = "foxglove.sdk.v1"
WELL_KNOWN = {"/tf": FrameTransformsChannel, "/scene": SceneUpdateChannel, "/joint_states": JointStatesChannel}
NUMBERS = {FieldDescriptor.TYPE_DOUBLE, FieldDescriptor.TYPE_FLOAT}
INTEGERS = {FieldDescriptor.TYPE_UINT32, FieldDescriptor.TYPE_FIXED32}


def kinds(value):
    """Returns the structure of a message: the names and types of its fields, without their values."""
    return {name: type(member).__name__ for name, member in value.items()}


def differences(message, schema, path):
    """Returns the differences between the message of a Protocol Buffers descriptor and a JSON schema."""
    if message.full_name in ("google.protobuf.Timestamp", "google.protobuf.Duration"):
        title = {"Timestamp": "time", "Duration": "duration"}[message.name]
        same = schema.get("title") == title and set(schema["properties"]) == {"sec", "nsec"}
        return [] if same else [f"{path}: {message.full_name} is {schema}"]
    found = []
    if schema.get("title") != message.full_name:
        found.append(f"{path}: {message.full_name} is called {schema.get('title')}")
    ours, theirs = set(schema["properties"]), {field.name for field in message.fields}
    if ours != theirs:
        found.append(f"{path}: {ours ^ theirs}")
    for field in message.fields:
        if field.name in ours:
            found += field_differences(field, schema["properties"][field.name], f"{path}.{field.name}")
    needed = {field.name for field in message.fields if not field.containing_oneof}
    if set(schema["required"]) != needed:
        found.append(f"{path}: required {set(schema['required']) ^ needed}")
    return found


def field_differences(field, schema, path):
    if field.is_repeated:
        if schema.get("type") != "array":
            return [f"{path}: is not a list"]
        schema = schema["items"]
    if field.message_type:
        return differences(field.message_type, schema, path)
    if field.enum_type:
        ours = {(choice["title"], choice["const"]) for choice in schema.get("oneOf", [])}
        theirs = {(value.name, value.number) for value in field.enum_type.values}
        return [] if ours == theirs else [f"{path}: {ours ^ theirs}"]
    wanted = {FieldDescriptor.TYPE_STRING: "string", FieldDescriptor.TYPE_BYTES: "string",
              FieldDescriptor.TYPE_BOOL: "boolean"}.get(field.type)
    wanted = wanted or ("number" if field.type in NUMBERS else "integer" if field.type in INTEGERS else "?")
    return [] if schema.get("type") == wanted else [f"{path}: {schema.get('type')} for {wanted}"]


def fill(message, value):
    """Converts a JSON message to Protocol Buffers. An unknown name or a wrong type is an error."""
    for name, member in value.items():
        field = message.DESCRIPTOR.fields_by_name[name]
        if field.is_repeated:
            for item in member:
                if field.message_type:
                    fill(getattr(message, name).add(), item)
                else:
                    getattr(message, name).append(item)
        elif field.message_type and field.message_type.full_name.startswith("google.protobuf."):
            getattr(message, name).SetInParent()
            getattr(message, name).seconds, getattr(message, name).nanos = member["sec"], member["nsec"]
        elif field.message_type:
            getattr(message, name).SetInParent()
            fill(getattr(message, name), member)
        else:
            setattr(message, name, member)


def descriptor(schema_name, base64_set):
    files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(base64_set + "=="))
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return pool.FindMessageTypeByName(schema_name)


def greeting(client):
    """Returns what a server sends without a request: (serverInfo, {topic: channel})."""
    info = client.next_op("serverInfo")
    return info, {channel["topic"]: channel for channel in client.next_op("advertise")["channels"]}


class SdkServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.predictor = Predictor(os.environ["PREDICTOR_BINARY"])
        cls.addClassCleanup(cls.predictor.close)
        cls.ours = RawClient(cls.predictor.foxglove_url, [SDK])
        cls.addClassCleanup(cls.ours.close)
        cls.our_info, cls.our_channels = greeting(cls.ours)
        cls.start_sdk()
        cls.theirs = RawClient(cls.sdk_url, [SDK])
        cls.addClassCleanup(cls.theirs.close)
        cls.their_info, cls.their_channels = greeting(cls.theirs)

    @classmethod
    def start_sdk(cls):
        """Starts Foxglove's server with our topics and schemas, and the well-known ones in its own encoding."""
        context = cls.context = foxglove.Context()  # the server ends with it
        cls.json_channels = {
            topic: foxglove.Channel(topic, schema=json.loads(channel["schema"]) | {"title": channel["schemaName"]},
                                    context=context)
            for topic, channel in cls.our_channels.items()}
        cls.typed = {topic: kind("/typed" + topic, context=context) for topic, kind in WELL_KNOWN.items()}
        server = foxglove.start_server(name="PREDICTOR", port=0, context=context)
        cls.addClassCleanup(server.stop)
        cls.sdk_url = f"ws://127.0.0.1:{server.port}/"

    def test_both_speak_the_same_subprotocol_and_refuse_others(self):
        for url, client in ((self.predictor.foxglove_url, self.ours), (self.sdk_url, self.theirs)):
            self.assertEqual((client.status, client.subprotocol), (101, SDK))
            with contextlib.closing(RawClient(url, ["something.else"])) as other:
                self.assertEqual(other.status, 400)

    def test_server_info_has_the_same_shape(self):
        self.assertEqual(kinds(self.our_info), kinds(self.their_info))
        self.assertEqual(self.our_info["capabilities"], self.their_info["capabilities"])

    def test_channels_are_advertised_alike(self):
        for topic, ours in self.our_channels.items():
            theirs = self.their_channels[topic]
            self.assertEqual(kinds(ours), kinds(theirs), topic)
            for name in ("topic", "encoding", "schemaName", "schemaEncoding"):
                self.assertEqual(ours[name], theirs[name], topic)
            self.assertEqual(json.loads(ours["schema"]), json.loads(theirs["schema"]), topic)

    def test_frames_are_the_same_bytes(self):
        """Both servers must send the same frames for the same message. The log time must agree with the message's own."""
        wanted = {100 + k: topic for k, topic in enumerate(self.our_channels)}
        for client, channels in ((self.ours, self.our_channels), (self.theirs, self.their_channels)):
            client.send({"op": "subscribe", "subscriptions": [
                {"id": number, "channelId": channels[topic]["id"]} for number, topic in wanted.items()]})
        seen = {}
        while len(seen) < len(wanted):
            subscription, time, payload = self.ours.next_data()
            seen[subscription] = (time, payload)
        for subscription, (time, payload) in seen.items():
            self.json_channels[wanted[subscription]].log(payload, log_time=time)
            self.assertEqual(self.theirs.next_data(), (subscription, time, payload), wanted[subscription])
            stamp = json.loads(payload).get("timestamp")
            if stamp:
                self.assertEqual(stamp["sec"] * 10**9 + stamp["nsec"], time)
        for client in (self.ours, self.theirs):
            client.send({"op": "unsubscribe", "subscriptionIds": list(wanted)})

    def test_unsubscribed_is_silent_and_an_unknown_channel_is_reported(self):
        for url, channels, log in ((self.predictor.foxglove_url, self.our_channels, lambda topic: None),
                                   (self.sdk_url, self.their_channels, lambda topic: self.json_channels[topic].log({}))):
            with contextlib.closing(RawClient(url, [SDK])) as client:
                greeting(client)
                client.send({"op": "subscribe", "subscriptions": [{"id": 9, "channelId": channels["/run"]["id"]}]})
                client.send({"op": "unsubscribe", "subscriptionIds": [9]})
                client.send({"op": "subscribe", "subscriptions": [{"id": 10, "channelId": 987654}]})
                # The arrival of this message shows that the server has processed the
                # unsubscription.
                status = client.next_op("status")
                self.assertIn(status["level"], (1, 2), status)
                self.assertTrue(status["message"])
                client.send({"op": "subscribe", "subscriptions": [{"id": 11, "channelId": channels["/tf"]["id"]}]})
                client.send({"op": "subscribe", "subscriptions": [{"id": 12, "channelId": 987654}]})
                client.next_op("status")
                log("/run")
                log("/tf")
                self.assertEqual(client.next_data()[0], 11)

    def test_well_known_schemas_mean_the_same(self):
        for topic in WELL_KNOWN:
            ours, theirs = self.our_channels[topic], self.their_channels["/typed" + topic]
            self.assertEqual(ours["schemaName"], theirs["schemaName"])
            self.assertEqual(theirs["schemaEncoding"], "protobuf")
            message = descriptor(theirs["schemaName"], theirs["schema"])
            schema = json.loads(ours["schema"])
            self.assertEqual(differences(message, schema, topic), [])
            del schema["properties"][next(iter(schema["properties"]))]
            self.assertNotEqual(differences(message, schema, topic), [], "nothing is compared")

    def test_our_contents_are_messages_of_theirs(self):
        """It must be possible to convert each of our messages completely to Foxglove's own type."""
        wanted = {200 + k: topic for k, topic in enumerate(WELL_KNOWN)}
        self.ours.send({"op": "subscribe", "subscriptions": [
            {"id": number, "channelId": self.our_channels[topic]["id"]} for number, topic in wanted.items()]})
        seen = {}
        while len(seen) < len(wanted):
            subscription, _, payload = self.ours.next_data()
            if subscription in wanted:
                seen[subscription] = json.loads(payload)
        for subscription, value in seen.items():
            channel = self.their_channels["/typed" + wanted[subscription]]
            message = message_factory.GetMessageClass(descriptor(channel["schemaName"], channel["schema"]))()
            fill(message, value)
            self.assertEqual(type(message).FromString(message.SerializeToString()), message)
            self.assertGreater(len(json_format.MessageToDict(message)), 0)
        self.ours.send({"op": "unsubscribe", "subscriptionIds": list(wanted)})


if __name__ == "__main__":
    unittest.main()
