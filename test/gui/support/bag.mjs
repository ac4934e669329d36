// Reads uncompressed ROS 1 bags: what the tests compare the page with. Format: http://wiki.ros.org/Bags/Format/2.0
import {readdirSync, readFileSync} from "node:fs";
import {join} from "node:path";

const magic = "#ROSBAG V2.0\n";
const operation = {message: 2, chunk: 5, connection: 7};

/** @param folder a recording of the recorder. @return texts of its std_msgs/String messages by topic, as JSON values in the order of their time. */
export function readJson(folder) {
  const topics = new Map();
  for (const name of readdirSync(folder).filter(n => n.endsWith(".bag")).sort()) {
    const file = readFileSync(join(folder, name));
    if (file.toString("latin1", 0, magic.length) !== magic) throw new Error(`${name} begins with no ${magic.trim()}`);
    const connections = new Map();
    for (const record of records(file.subarray(magic.length))) {
      if (record.operation !== operation.chunk) continue;
      const compression = record.fields.get("compression").toString();
      if (compression !== "none") throw new Error(`${name}: compression ${compression} (expected none)`);
      for (const inner of records(record.data)) takeInner(inner, connections, topics);
    }
  }
  return topics;
}

function takeInner(record, connections, topics) {
  if (record.operation === operation.connection) {
    connections.set(record.fields.get("conn").readUInt32LE(), {topic: record.fields.get("topic").toString(), type: fieldsOf(record.data).get("type").toString()});
  } else if (record.operation === operation.message) {
    const {topic, type} = connections.get(record.fields.get("conn").readUInt32LE());
    if (type !== "std_msgs/String") return;
    if (!topics.has(topic)) topics.set(topic, []);
    topics.get(topic).push(JSON.parse(record.data.toString("utf8", 4, 4 + record.data.readUInt32LE())));
  }
}

function* records(bytes) {
  for (let at = 0; at < bytes.length;) {
    const headerEnd = at + 4 + bytes.readUInt32LE(at), dataEnd = headerEnd + 4 + bytes.readUInt32LE(headerEnd);
    const fields = fieldsOf(bytes.subarray(at + 4, headerEnd));
    yield {fields, operation: fields.get("op").readUInt8(), data: bytes.subarray(headerEnd + 4, dataEnd)};
    at = dataEnd;
  }
}

function fieldsOf(bytes) {
  const fields = new Map();
  for (let at = 0; at < bytes.length;) {
    const end = at + 4 + bytes.readUInt32LE(at), equals = bytes.indexOf("=", at + 4);
    fields.set(bytes.toString("latin1", at + 4, equals), bytes.subarray(equals + 1, end));
    at = end;
  }
  return fields;
}
