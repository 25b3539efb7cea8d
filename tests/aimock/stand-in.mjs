// A language and vision model that is none: aimock over HTTP, with one function for an answer.
// It plays a building of three doors and two paintings; the file named by MODE makes it say nonsense.
import { readFileSync } from "node:fs";
import { inflateSync } from "node:zlib";
import { LLMock } from "@copilotkit/aimock";

const mode = () => {
  try {
    return readFileSync(process.env.MODE, "utf8").trim();
  } catch {
    return "";
  }
};

const textOf = (content) =>
  typeof content === "string" ? content : content.filter((part) => part.type === "text").map((part) => part.text).join("\n");

// What is written on a plate, by its colour.
const plates = { "200,0,0": "901", "0,0,200": "910", "9,9,9": "903" };

// The first pixel of a PNG file: the first of its first row is the same under every filter.
function colour(png) {
  const data = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) {
    if (png.toString("latin1", at + 4, at + 8) === "IDAT") data.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  }
  return [...inflateSync(Buffer.concat(data)).subarray(1, 4)].join();
}

function look(message) {
  const uri = message.content.find((part) => part.type === "image_url").image_url.url;
  return plates[colour(Buffer.from(uri.split(",")[1], "base64"))] ?? "unknown";
}

function answer(request) {
  switch (mode()) {
    case "prose":
      return "I would rate them 5 out of 5: they are surely the same.";
    case "six":
      return "6";
    case "hang":
      return new Promise(() => {});
    case "hang-again":
      if (JSON.stringify(request.messages).includes("once more")) return new Promise(() => {});
  }
  const user = request.messages.at(-1);
  if (Array.isArray(user.content)) return look(user);
  const data = JSON.parse(textOf(user.content));
  if (request.response_format?.json_schema?.name === "level") {
    return JSON.stringify({ reason: "so it was told", level: "a" in data ? 4 : 5 });
  }
  if (request.response_format?.json_schema?.name === "text") {
    return JSON.stringify({ text: `${data.a}, ${data.b}` });
  }
  const rules = textOf(request.messages[0].content);
  return rules.includes("Ask one short question") ? `What else, beside ${data.asked.length} things?` : "unknown";
}

const mock = new LLMock({ port: 0, logLevel: "silent" });
mock.on({ predicate: () => true }, async (request) => {
  switch (mode()) {
    case "refusal":
      return { content: "", refusal: "I cannot help with that.", finishReason: "content_filter" };
    case "empty":
      return { content: "" };
    case "401":
      return { error: { message: "Incorrect API key", type: "invalid_request_error" }, status: 401 };
  }
  return { content: await answer(request) };
});
await mock.start();
console.log(mock.url);
