// The answer of a loop query. Values that a later server adds are kept as text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry.hpp"
#include "json.hpp"

namespace revisit {

/// `other` is a value that this version does not know; its text is beside it.
enum class Decision { loop, no_loop, undecided, rejected, other };

inline Decision decision_of(const std::string& text) noexcept {
    if (text == "loop") return Decision::loop;
    if (text == "no_loop") return Decision::no_loop;
    if (text == "undecided") return Decision::undecided;
    if (text == "rejected") return Decision::rejected;
    return Decision::other;
}

struct Candidate {
    std::string keyframe;
    Decision decision = Decision::other;
    std::string verdict;
    double bow_score = 0;
    double anchor_similarity = 0;
    /// `verified`, `failed`, `skipped`, or what a later server says.
    std::string geometry;
    int inliers = 0;
    /// Present where geometry was verified: maps points of the query's camera to the candidate's.
    std::optional<Similarity> candidate_from_query;
    /// Of that transform, row by row: x, y, z, rotation about x, y, z; empty where there is none.
    std::vector<double> covariance;
    std::string reason;
};

struct Verdict {
    std::string id;
    std::string keyframe;
    Decision decision = Decision::other;
    std::string verdict;
    /// Empty if there is none.
    std::string best;
    std::vector<std::string> loops;
    std::vector<Candidate> candidates;
    std::string reason;
    bool degraded = false;
    std::int64_t map_version = 0;
    /// The whole answer.
    Json json;

    const Candidate* find(const std::string& candidate) const noexcept {
        for (const auto& one : candidates)
            if (one.keyframe == candidate) return &one;
        return nullptr;
    }
};

namespace detail {

inline Vector3 vector_of(const Json& json) { return {json["x"].number(), json["y"].number(), json["z"].number()}; }

inline Similarity similarity_of_json(const Json& json) {
    const auto& q = json["rotation"];
    return {json["scale"].number(1), vector_of(json["translation"]), {q["x"].number(), q["y"].number(), q["z"].number(), q["w"].number(1)}};
}

}  // namespace detail

/// Reads a verdict from `loop` of a keyframe's answer, or from a loop query's.
inline Result<Verdict> verdict_of(Json json) noexcept {
    return detail::guarded([&]() -> Result<Verdict> {
        if (json["verdict"].text().empty()) return Error(Code::malformed_answer, "no verdict");
        Verdict verdict;
        verdict.id = json["id"].text();
        verdict.keyframe = json["keyframe"].text();
        verdict.verdict = json["verdict"].text();
        verdict.decision = decision_of(verdict.verdict);
        verdict.best = json["best"].text();
        verdict.reason = json["reason"]["code"].text();
        verdict.degraded = json["degraded"].boolean();
        verdict.map_version = json["map_version"].integer();
        for (const auto& loop : json["loops"].items()) verdict.loops.push_back(loop.text());
        for (const auto& item : json["candidates"].items()) {
            Candidate candidate;
            candidate.keyframe = item["keyframe"].text();
            candidate.verdict = item["verdict"].text();
            candidate.decision = decision_of(candidate.verdict);
            candidate.bow_score = item["bow"]["score"].number();
            candidate.anchor_similarity = item["anchors"]["similarity"].number();
            const auto& geometry = item["geometry"];
            candidate.geometry = geometry["status"].text();
            candidate.inliers = static_cast<int>(geometry["inliers"].integer());
            if (!geometry["candidate_from_query"].is_null()) candidate.candidate_from_query = detail::similarity_of_json(geometry["candidate_from_query"]);
            for (const auto& number : geometry["covariance"].items()) candidate.covariance.push_back(number.number());
            candidate.reason = item["reason"]["code"].text();
            verdict.candidates.push_back(std::move(candidate));
        }
        verdict.json = std::move(json);
        return verdict;
    });
}

}  // namespace revisit
