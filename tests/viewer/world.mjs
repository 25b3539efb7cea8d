// World: a corridor with a plan, which robots drive through: enough for loops, contradictions, crops and alignments.

import { deflateSync } from "node:zlib";

/** A level camera that looks along x: x right is -y, y down is -z. */
const LEVEL = { x: -0.5, y: 0.5, z: -0.5, w: 0.5 };
const DOOR_EVERY_M = 2;
const AHEAD_M = 5;

/** The number on a door of the corridor. */
export function doorNumber(floor, index) {
  return String(floor * 100 + index + 1);
}

/** Where a door's sign is in the plan of its floor. */
function doorPlace(index) {
  return [1 + DOOR_EVERY_M * Math.floor(index / 2), index % 2 === 0 ? 1.2 : -1.2, 1.6];
}

/**
 * The keyframes of one drive. `offset` is where the plan's origin is in the robot's frame, `reads(index)` what a door reads
 * (null: no sign), `crops` whether pictures come along.
 */
export function drive(session, { doors = 8, steps = 7, offset = [0, 0, 0], begins = 1, reads, crops = false }) {
  return Array.from({ length: steps }, (_, step) => {
    const at = [step, 0, 1.2];
    const seen = Array.from({ length: doors }, (_, index) => index).filter((index) => {
      const ahead = doorPlace(index)[0] - at[0];
      return ahead > 0.2 && ahead < AHEAD_M && reads(index) !== null;
    });
    const moved = (place) => place.map((metres, axis) => metres + offset[axis]);
    const [x, y, z] = moved(at);
    return {
      id: `${session}-${step}`,
      body: {
        session, stamp: { sec: begins + step, nanosec: 0 }, covisible: step > 0 ? [{ keyframe: `${session}-${step - 1}`, shared: 50 }] : [], pose: { translation: { x, y, z }, rotation: LEVEL },
        bow: { words: [step, 100 + step], weights: [0.5, 0.5] },
        detections: seen.map((index) => ({
          class: "door_number", confidence: 0.9, box: [10 * index, 10, 10 * index + 8, 18], text: reads(index), position: moved(doorPlace(index)),
          ...(crops ? { crop: picture(index) } : {}),
        })),
      },
    };
  });
}

/** The signs of a floor's plan. */
export function plan(floor, doors = 8) {
  return Array.from({ length: doors }, (_, index) => ({
    id: `door-${doorNumber(floor, index)}`,
    body: { class: "door_number", description: doorNumber(floor, index), position: doorPlace(index), frame: `plan:${floor}` },
  }));
}

/** A PNG of one colour, base64. */
export function picture(index, width = 48, height = 24) {
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let at = 0; at < rows.length; at += 1) rows[at] = at % (1 + 3 * width) === 0 ? 0 : (60 + 37 * index * (at % 3 + 1)) % 256;
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 2, 0, 0, 0], 8);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([signature, chunk("IHDR", header), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]).toString("base64");
}

function chunk(kind, data) {
  const body = Buffer.concat([Buffer.from(kind), data]);
  const length = Buffer.alloc(4);
  length.writeUInt32BE(data.length);
  const sum = Buffer.alloc(4);
  sum.writeUInt32BE(checksum(body));
  return Buffer.concat([length, body, sum]);
}

function checksum(bytes) {
  let sum = 0xffffffff;
  for (const byte of bytes) {
    sum ^= byte;
    for (let bit = 0; bit < 8; bit += 1) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
  }
  return (sum ^ 0xffffffff) >>> 0;
}

/**
 * A map of one floor: `robot-1` and `robot-2` drive along its corridor and are aligned to its plan, `robot-2` reads 930 on 903;
 * `robot-3` drives on the floor below, which has no plan and no pictures.
 */
export async function tower(server) {
  await server.ask("PUT", "/v1/maps/tower", {});
  for (const { id, body } of plan(9)) await server.ask("PUT", `/v1/maps/tower/anchors/${id}`, body);
  const misread = (index) => (index === 2 ? "930" : doorNumber(9, index));
  await server.send("tower", [
    ...drive("robot-1", { reads: (index) => doorNumber(9, index), crops: true }),
    ...drive("robot-2", { reads: misread, offset: [20, 5, 0], begins: 1000, crops: true }),
    ...drive("robot-3", { reads: (index) => doorNumber(8, index), offset: [0, 20, 0], begins: 2000 }),
  ]);
  return server;
}
