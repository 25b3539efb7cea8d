// Client that waits for each answer: for tools and tests. A robot uses the `Sender`.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "http.hpp"
#include "json.hpp"
#include "keyframe.hpp"
#include "keyframe_json.hpp"
#include "operations.hpp"
#include "updates.hpp"
#include "verdict.hpp"

namespace revisit {

using Names = std::vector<std::pair<std::string, std::string>>;

/// What a call of an operation is made of: `path` fills the `{names}` of its path.
struct Call {
    Names path;
    Names query;
    Names headers;
    std::string body;
};

struct Answer {
    int status = 0;
    /// Null where the answer is not JSON; `text` has it then.
    Json json;
    std::string text;
    /// Whether the server had this write already.
    bool is_replayed = false;
};

/// What is asked about a keyframe.
struct Question {
    /// `anchors` leaves geometry to a host that verifies by itself; `geometry` demands it.
    enum class Verify { automatic, anchors, geometry };
    Verify verify = Verify::automatic;
    /// How long the server waits for descriptions that a language model owes.
    int max_wait_ms = 0;
    /// Leaves out rejected candidates and the matches of the others.
    bool brief = false;

    bool is_plain() const noexcept { return verify == Verify::automatic && max_wait_ms == 0; }
};

namespace detail {

inline const char* name_of(Question::Verify verify) noexcept {
    return verify == Question::Verify::anchors ? "anchors" : verify == Question::Verify::geometry ? "geometry" : "auto";
}

inline std::string question_body(const std::string& keyframe, const Question& question) {
    std::string out;
    ObjectWriter object(out);
    object.text("keyframe", keyframe);
    object.text("verify", name_of(question.verify));
    if (question.max_wait_ms > 0) append_integer(object.name("max_wait_ms"), question.max_wait_ms);
    object.close();
    return out;
}

inline Result<Request> request_of(const std::string& id, Call call) {
    const Operation* operation = find_operation(id);
    if (operation == nullptr) return Error(Code::invalid, "/operation", "there is no operation " + id);
    Request request;
    request.method = operation->method;
    if (id == "put_keyframes") request.content_type = "application/x-ndjson";
    const std::string path = operation->path;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] != '{') {
            request.target += path[i];
            continue;
        }
        const std::size_t end = path.find('}', i);
        const std::string name = path.substr(i + 1, end - i - 1);
        bool found = false;
        for (const auto& part : call.path) {
            if (part.first != name) continue;
            // An empty id or one of dots would name another resource.
            if (part.second.empty() || part.second == "." || part.second == "..") return Error(Code::invalid, "/" + name, "not an id");
            request.target += percent_encoded(part.second);
            found = true;
        }
        if (!found) return Error(Code::invalid, "/" + name, "required");
        i = end;
    }
    for (std::size_t i = 0; i < call.query.size(); ++i)
        request.target += (i == 0 ? "?" : "&") + percent_encoded(call.query[i].first) + "=" + percent_encoded(call.query[i].second);
    for (const auto& header : call.headers)
        if ((header.first + header.second).find_first_of("\r\n") != std::string::npos) return Error(Code::invalid, "/headers", "a line break");
    request.headers = std::move(call.headers);
    request.body = std::move(call.body);
    return request;
}

/// Turns an answer of 400 and above into its error.
inline Result<Answer> answer_of(Response response) {
    Answer answer;
    answer.status = response.status;
    answer.is_replayed = response.is_replayed;
    auto json = Json::parse(response.body);
    if (response.status >= 400) {
        Error error(Code::problem);
        error.status = response.status;
        error.retry_after_s = response.retry_after_s;
        if (json) {
            error.problem = (*json)["code"].text();
            error.detail = (*json)["detail"].text();
            for (const auto& item : (*json)["errors"].items())
                error.faults.push_back({item["pointer"].text(), item["detail"].text(), item["got"].text(), item["limit"].text()});
            if (!error.faults.empty()) error.field = error.faults.front().pointer;
        } else {
            error.detail = "HTTP " + std::to_string(response.status);
        }
        return error;
    }
    if (response.status < 200 || response.status >= 300) return Error(Code::malformed_answer, "HTTP " + std::to_string(response.status));
    if (json) answer.json = std::move(*json);
    answer.text = std::move(response.body);
    return answer;
}

}  // namespace detail

class Client {
public:
    static Result<Client> open(const Endpoint& endpoint) noexcept {
        auto connection = detail::Connection::open(endpoint);
        if (!connection) return connection.error();
        return Client(std::move(*connection));
    }

    /// Calls an operation by its id in the API document.
    Result<Answer> call(const std::string& operation, Call call) noexcept {
        return detail::guarded([&]() -> Result<Answer> {
            auto request = detail::request_of(operation, std::move(call));
            if (!request) return request.error();
            const bool is_compressed = detail::compress(request->body);
            auto response = connection_->send(*request, is_compressed);
            if (!response) return response.error();
            return detail::answer_of(std::move(*response));
        });
    }

    Result<Answer> put_map(const std::string& map, const std::string& body = "{}") noexcept {
        return made("put_map", [&] { return Call{{{"map", map}}, {}, {}, body}; });
    }

    Result<Answer> put_keyframe(const std::string& map, const Keyframe& keyframe, bool asks_for_loop = false, const Precision& precision = Precision()) noexcept {
        if (auto status = check(keyframe); !status) return status.error();
        return made("put_keyframe", [&] {
            Call call{{{"map", map}, {"keyframe", keyframe.id}}, {}, {}, {}};
            if (asks_for_loop) call.query.emplace_back("query", "loop");
            detail::append_keyframe(call.body, keyframe, precision);
            return call;
        });
    }

    Result<Verdict> query_loop(const std::string& map, const std::string& keyframe, const Question& question = Question()) noexcept {
        auto answer = made("query_loop", [&] {
            Call call{{{"map", map}}, {}, {}, detail::question_body(keyframe, question)};
            if (question.brief) call.query.emplace_back("detail", "brief");
            return call;
        });
        if (!answer) return answer.error();
        return verdict_of(std::move(answer->json));
    }

    Result<Answer> confirm_loop(const std::string& map, const Loop& loop) noexcept {
        if (auto status = check(loop); !status) return status.error();
        return made("confirm_loop", [&] { return Call{{{"map", map}}, {}, {}, detail::body_of(loop)}; });
    }

    Result<Answer> revoke_loop(const std::string& map, const std::string& loop) noexcept {
        return made("revoke_loop", [&] { return Call{{{"map", map}, {"loop", loop}}, {}, {}, {}}; });
    }

    Result<Answer> correct_poses(const std::string& map, const PoseCorrections& corrections, const Precision& precision = Precision()) noexcept {
        if (auto status = check(corrections); !status) return status.error();
        return made("correct_poses", [&] { return Call{{{"map", map}}, {}, {}, detail::body_of(corrections, precision)}; });
    }

    Result<Answer> change_observations(const std::string& map, const Observations& observations) noexcept {
        if (auto status = check(observations); !status) return status.error();
        return made("change_observations", [&] { return Call{{{"map", map}}, {}, {}, detail::body_of(observations)}; });
    }

    Result<Answer> merge_sessions(const std::string& map, const SessionMerge& merge) noexcept {
        if (auto status = check(merge); !status) return status.error();
        return made("merge_sessions", [&] { return Call{{{"map", map}, {"session", merge.session}}, {}, {}, detail::body_of(merge)}; });
    }

    Result<Answer> delete_keyframe(const std::string& map, const std::string& keyframe) noexcept {
        return made("delete_keyframe", [&] { return Call{{{"map", map}, {"keyframe", keyframe}}, {}, {}, {}}; });
    }

private:
    explicit Client(std::unique_ptr<detail::Connection> connection) noexcept : connection_(std::move(connection)) {}

    template <class F>
    Result<Answer> made(const char* operation, F&& make) noexcept {
        return detail::guarded([&]() -> Result<Answer> { return call(operation, make()); });
    }

    std::unique_ptr<detail::Connection> connection_;
};

}  // namespace revisit
