// Weights of a bag of words in the server's own unit: shorter to write than the host's, and the same vector to the server.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "keyframe.hpp"

namespace revisit::detail {

/// The whole, in units: the server normalises weights to integers that sum to it (`crates/core/src/domain/bow.rs`).
constexpr std::int64_t whole_bow = std::int64_t{1} << 31;

/// Returns each word's units. What is in units already comes back unchanged, so that the server makes the same of both.
inline std::vector<std::int64_t> bow_units(const Bow& bow) {
    const auto& weights = bow.weights;
    std::vector<std::int64_t> units(weights.size(), 0);
    std::vector<std::size_t> order(weights.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    order.erase(std::remove_if(order.begin(), order.end(), [&](std::size_t i) { return !(weights[i] > 0); }), order.end());
    if (order.empty()) return units;
    // By word, as the server adds them up: another order rounds otherwise.
    const auto by_word = [&](std::size_t a, std::size_t b) { return bow.words[a] != bow.words[b] ? bow.words[a] < bow.words[b] : a < b; };
    if (!std::is_sorted(order.begin(), order.end(), by_word)) std::sort(order.begin(), order.end(), by_word);
    double largest = 0, sum = 0;
    for (const auto i : order) largest = std::max(largest, weights[i]);
    for (const auto i : order) sum += weights[i] / largest;
    std::int64_t left_over = whole_bow;
    for (const auto i : order) {
        units[i] = static_cast<std::int64_t>(std::max(1.0, std::round(weights[i] / largest / sum * static_cast<double>(whole_bow))));
        left_over -= units[i];
    }
    if (left_over == 0) return units;
    // What rounding leaves over goes, unit by unit, to the largest.
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return weights[a] != weights[b] ? weights[a] > weights[b] : by_word(a, b); });
    for (std::size_t next = 0; left_over != 0;) {
        std::int64_t& one = units[order[next]];
        next = (next + 1) % order.size();
        if (left_over > 0) {
            ++one;
            --left_over;
        } else if (one > 1) {
            --one;
            ++left_over;
        } else {
            // No later word has more than one unit.
            next = 0;
        }
    }
    return units;
}

}  // namespace revisit::detail
