// A writer for proofs: makes every kind of write with the `Sender` that standard input asks for, and prints each outcome.
//
// writer URL MAP
// A line of input is {"kind", "id", "body"}, with a body as the API has it; a line of output {"kind", "id", "status", "answer"}. The
// status is 0 where the client refused the call. It ends with its input, whatever was not sent by then.
#include <cstdio>
#include <iostream>

#include "keyframe_from_json.hpp"

using nlohmann::json;
using namespace revisit;

static void print(const char* kind, const std::string& id, int status, const json& answer) {
    const std::string line = json{{"kind", kind}, {"id", id}, {"status", status}, {"answer", answer}}.dump();
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

static const char* name_of(Outcome::Kind kind) {
    switch (kind) {
        case Outcome::Kind::keyframe: return "keyframe";
        case Outcome::Kind::poses: return "poses";
        case Outcome::Kind::observations: return "observations";
        case Outcome::Kind::confirmation: return "confirmation";
        case Outcome::Kind::revocation: return "revocation";
        case Outcome::Kind::removal: return "removal";
        default: return "other";
    }
}

static void report(const Outcome& outcome) {
    if (outcome.ok()) {
        std::string text;
        outcome.answer.write(text);
        return print(name_of(outcome.kind), outcome.id, outcome.status, json::parse(text));
    }
    const auto& error = outcome.error;
    print(name_of(outcome.kind), outcome.id, outcome.status, {{"status", outcome.status}, {"code", error.problem}, {"field", error.field}, {"detail", error.detail}});
}

static Status correct(Sender& sender, const json& body) {
    PoseCorrections corrections;
    corrections.session = body["session"];
    corrections.keyframes = body["keyframes"]["ids"].get<std::vector<std::string>>();
    for (const auto& pose : body["keyframes"]["poses"]) corrections.poses.push_back(pose_from(pose));
    return sender.correct(std::move(corrections));
}

static Status update(Sender& sender, const json& body) {
    Observations observations;
    observations.session = body["session"];
    for (const auto& pair : body.value("replaced", json::array())) observations.replaced.emplace_back(pair[0], pair[1]);
    for (const auto& point : body.value("removed", json::array())) observations.removed.push_back(point);
    for (const auto& one : body.value("keyframes", json::array()))
        observations.keyframes.push_back({one["keyframe"], one["observes"].get<std::vector<std::int64_t>>(), std::nullopt});
    return sender.update(std::move(observations));
}

static Status call(Sender& sender, const std::string& kind, const std::string& id, const json& body) {
    if (kind == "keyframe") return sender.send(keyframe_from(id, body));
    // A verdict changes nothing of the write; its answer comes as the write's own.
    if (kind == "asking") return sender.send(keyframe_from(id, body), Question());
    if (kind == "poses") return correct(sender, body);
    if (kind == "observations") return update(sender, body);
    if (kind == "confirmation") return sender.confirm({id, body["keyframe"], body["candidate"], ""});
    if (kind == "revocation") return sender.revoke(id);
    if (kind == "removal") return sender.remove(id);
    return Error(Code::invalid, "/kind", kind);
}

int main(int count, char** arguments) {
    if (count < 3) return 2;
    SenderOptions options;
    options.endpoint.url = arguments[1];
    options.map = arguments[2];
    options.closing_ms = 0;
    // The server comes back soon, and the proof waits for it.
    options.longest_wait_ms = 200;
    options.on_outcome = report;
    auto sender = Sender::open(options);
    if (!sender) return 1;
    for (std::string line; std::getline(std::cin, line);) {
        const auto asked = json::parse(line);
        const std::string kind = asked["kind"], id = asked["id"];
        const Status status = call(**sender, kind, id, asked["body"]);
        if (!status) print(kind == "asking" ? "keyframe" : kind.c_str(), id, 0, {{"status", 0}, {"field", status.error().field}, {"detail", status.error().detail}});
    }
    return 0;
}
