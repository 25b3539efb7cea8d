// The stella_vslam adapter on stand-ins: verified loops alone are requested, and a rejected request blocks nothing.
#include <array>
#include <random>

#include <nlohmann/json.hpp>
#include <revisit/stella_vslam.hpp>

#include "check.hpp"
#include "orb_slam3_stand_in.hpp"
#include "server.hpp"
#include "stand_in.hpp"

using namespace revisit;
using namespace std::chrono_literals;

constexpr auto forever = 250s;

namespace standin {

struct Matrix4 {
    std::array<double, 16> data{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double operator()(int row, int column) const { return data[static_cast<std::size_t>(4 * row + column)]; }
};

struct Landmark {
    unsigned id_ = 0;
    unsigned first_keyfrm_id_ = 0;
    Vector3d position;
    bool erased = false;
    bool will_be_erased() const { return erased; }
    Vector3d get_pos_in_world() const { return position; }
};

struct StellaKeyframe;

struct GraphNode {
    std::shared_ptr<StellaKeyframe> root;
    std::set<std::shared_ptr<StellaKeyframe>> loops;
    std::vector<std::shared_ptr<StellaKeyframe>> covisible;
    std::shared_ptr<StellaKeyframe> get_spanning_root() const { return root; }
    std::set<std::shared_ptr<StellaKeyframe>> get_loop_edges() const { return loops; }
    std::vector<std::shared_ptr<StellaKeyframe>> get_top_n_covisibilities(unsigned) const { return covisible; }
};

struct FrameObservation {
    Matrix descriptors_;
    std::vector<CvKeyPoint> undist_keypts_;
    std::vector<Vector3d> bearings_;
};

/// As FBoW's weight.
struct Weight {
    float value;
    operator float() const { return value; }
};

struct StellaKeyframe {
    unsigned id_ = 0;
    double timestamp_ = 0;
    FrameObservation frm_obs_;
    std::map<unsigned, Weight> bow_vec_;
    std::vector<std::shared_ptr<Landmark>> landmarks;
    std::unique_ptr<GraphNode> graph_node_ = std::make_unique<GraphNode>();
    Matrix4 pose;
    bool erased = false;
    bool will_be_erased() const { return erased; }
    Matrix4 get_pose_wc() const { return pose; }
    std::vector<std::shared_ptr<Landmark>> get_landmarks() const { return landmarks; }
};

struct Request {
    unsigned keyfrm1_id_, keyfrm2_id_;
};

/// The part of the host that a rejected request blocks: one place, emptied only by `finish`.
struct Host {
    std::mutex mutex;
    std::optional<Request> request;
    std::vector<std::pair<unsigned, unsigned>> requested;

    bool request_loop_closure(unsigned a, unsigned b) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (request) return false;
        request = Request{a, b};
        requested.emplace_back(a, b);
        return true;
    }
    void finish() {
        const std::lock_guard<std::mutex> lock(mutex);
        request.reset();
    }
    std::optional<Request> current() {
        const std::lock_guard<std::mutex> lock(mutex);
        return request;
    }
};

}  // namespace standin

using Shared = std::shared_ptr<standin::StellaKeyframe>;
using Adapter = stella_vslam::Adapter<standin::StellaKeyframe>;
static std::mt19937 chance(3);

static Shared keyframe(unsigned id, const Shared& root) {
    auto made = std::make_shared<standin::StellaKeyframe>();
    made->id_ = id;
    made->timestamp_ = 10.0 * id;
    made->bow_vec_ = {{3, {0.5f}}, {17, {0.5f}}};
    made->graph_node_->root = root;
    for (unsigned i = 0; i < 8; ++i) {
        made->frm_obs_.undist_keypts_.push_back({{static_cast<float>(40 * i + 20), 100}, 45, 1});
        const double angle = 0.3 * i;
        made->frm_obs_.bearings_.emplace_back(std::sin(angle), 0, std::cos(angle));
        for (int k = 0; k < 32; ++k) made->frm_obs_.descriptors_.data.push_back(static_cast<unsigned char>(chance()));
        auto landmark = std::make_shared<standin::Landmark>();
        landmark->id_ = 100 * id + i;
        landmark->first_keyfrm_id_ = id;
        landmark->position = {1, 2, static_cast<double>(i)};
        made->landmarks.push_back(i % 4 == 3 ? nullptr : landmark);
    }
    made->frm_obs_.descriptors_.rows = 8;
    return made;
}

/// Answers with a loop to the keyframe named in `loops`, verified or not.
struct Answers {
    std::map<std::string, std::pair<std::string, std::string>> loops;
    GivenAnswer operator()(const HeardRequest& request) const {
        std::string id = request.target.substr(request.target.rfind('/') + 1);
        id = id.substr(0, id.find('?'));
        const auto found = loops.find(id);
        nlohmann::json loop{{"id", "q"}, {"keyframe", id}, {"verdict", "no_loop"}, {"candidates", nlohmann::json::array()}};
        if (found != loops.end()) {
            loop["verdict"] = "loop";
            loop["best"] = found->second.first;
            loop["candidates"] = {{{"keyframe", found->second.first}, {"verdict", "loop"}, {"geometry", {{"status", found->second.second}}}}};
        }
        return {201, nlohmann::json{{"loop", loop}}.dump(), "", false, false};
    }
};

static std::unique_ptr<Adapter> adapter_of(const std::string& url, standin::Host& host) {
    stella_vslam::Options<standin::StellaKeyframe> options;
    options.sender.endpoint.url = url;
    options.sender.map = "tower";
    options.sender.makes_map = false;
    options.sender.closing_ms = 0;
    options.camera = {300, 300, 320, 240, 640, 480};
    options.request_loop_closure = [&host](unsigned a, unsigned b) { return host.request_loop_closure(a, b); };
    auto adapter = Adapter::open(options);
    CHECK_OK(adapter);
    return std::move(*adapter);
}

static void a_rejected_request_is_finished_and_the_next_one_made() {
    StandIn stand_in(Answers{{{"robot-5", {"robot-1", "verified"}}, {"robot-6", {"robot-2", "verified"}}}});
    standin::Host host;
    auto adapter = adapter_of(stand_in.url(), host);
    std::vector<Shared> all;
    for (unsigned id = 1; id <= 6; ++id) {
        all.push_back(keyframe(id, all.empty() ? nullptr : all[0]));
        if (id == 1) all[0]->graph_node_->root = all[0];
        CHECK_OK(adapter->insert(all.back()));
    }
    CHECK(adapter->sender().flush(forever));
    // One at a time: the other waits.
    CHECK_EQUAL(host.requested.size(), 1u);
    CHECK(host.requested[0] == std::make_pair(5u, 1u));
    const auto finish = [&] { host.finish(); };
    CHECK(!adapter->resolve(*host.current(), [](const standin::Request&) { return false; }, finish));
    CHECK_EQUAL(host.requested.size(), 2u);
    CHECK(host.requested[1] == std::make_pair(6u, 2u));
    const auto close = [&](const standin::Request& request) {
        CHECK_EQUAL(request.keyfrm1_id_, 6u);
        all[5]->graph_node_->loops.insert(all[1]);
        host.finish();
        return true;
    };
    CHECK(adapter->resolve(*host.current(), close, finish));
    CHECK(!host.current());
    CHECK(adapter->sender().flush(forever));
    const auto confirmed = nlohmann::json::parse(stand_in.heard().back().body);
    CHECK_EQUAL(confirmed.dump(), R"({"candidate":"robot-2","id":"robot-loop-6-2","keyframe":"robot-6"})");
    const auto stats = adapter->stats();
    CHECK_EQUAL(stats.requested, 2u);
    CHECK_EQUAL(stats.closed, 1u);
    CHECK_EQUAL(stats.rejected, 1u);
    // Neither the rejected nor the closed pair is requested again.
    CHECK_OK(adapter->sender().ask("robot-5"));
    CHECK_OK(adapter->insert(all[4]));
    CHECK_OK(adapter->insert(all[5]));
    CHECK(adapter->sender().flush(forever));
    CHECK_EQUAL(host.requested.size(), 2u);
    for (auto& one : all) one->graph_node_->root.reset(), one->graph_node_->loops.clear();
}

static void what_the_host_cannot_close_is_not_requested() {
    StandIn stand_in(Answers{{{"robot-3", {"robot-1", "skipped"}}, {"robot-4", {"robot-1", "verified"}}, {"robot-5", {"robot-2", "verified"}}, {"robot-6", {"other-1", "verified"}}, {"robot-7", {"robot-9", "verified"}}}});
    standin::Host host;
    auto adapter = adapter_of(stand_in.url(), host);
    auto root = keyframe(1, nullptr), erased = keyframe(2, nullptr);
    erased->erased = true;
    std::vector<Shared> all{root, erased};
    for (unsigned id = 3; id <= 7; ++id) all.push_back(keyframe(id, nullptr));
    // Of another spanning tree.
    all[3]->graph_node_->root = all[4];
    for (const auto& one : all) CHECK_OK(adapter->insert(one));
    CHECK(adapter->sender().flush(forever));
    CHECK(host.requested.empty());
    CHECK_EQUAL(adapter->stats().left_out, 4u);
    all[3]->graph_node_->root.reset();
}

// The host tries older candidates again, and its own detector closes loops meanwhile.
static void what_the_host_really_closed_is_confirmed_and_the_next_loop_comes_later() {
    StandIn stand_in(Answers{{{"robot-20", {"robot-1", "verified"}}, {"robot-25", {"robot-2", "verified"}}, {"robot-31", {"robot-3", "verified"}}}});
    standin::Host host;
    auto adapter = adapter_of(stand_in.url(), host);
    std::map<unsigned, Shared> all;
    const auto insert = [&](unsigned id) {
        all[id] = keyframe(id, all.empty() ? nullptr : all.begin()->second);
        if (id == 1) all[1]->graph_node_->root = all[1];
        CHECK_OK(adapter->insert(all[id]));
        CHECK(adapter->sender().flush(forever));
    };
    for (const unsigned id : {1u, 2u, 3u, 20u}) insert(id);
    const auto finish = [&] { host.finish(); };
    CHECK(host.requested.back() == std::make_pair(20u, 1u));
    const auto close = [&](const standin::Request&) {
        all[20]->graph_node_->loops.insert(all[2]);
        host.finish();
        return true;
    };
    CHECK(adapter->resolve(*host.current(), close, finish));
    CHECK(adapter->sender().flush(forever));
    CHECK_EQUAL(nlohmann::json::parse(stand_in.heard().back().body)["candidate"], "robot-2");
    // Five keyframes after it is too soon.
    insert(25);
    CHECK_EQUAL(host.requested.size(), 1u);
    insert(31);
    CHECK(host.requested.back() == std::make_pair(31u, 3u));
    // Its own detector was faster: it is not closed once more, and confirmed.
    all[31]->graph_node_->loops.insert(all[3]);
    CHECK(!adapter->resolve(*host.current(), [](const standin::Request&) -> bool { throw std::runtime_error("closed twice"); }, finish));
    CHECK(!host.current());
    CHECK(adapter->sender().flush(forever));
    CHECK_EQUAL(nlohmann::json::parse(stand_in.heard().back().body)["id"], "robot-loop-31-3");
    CHECK_EQUAL(adapter->stats().closed, 2u);
    for (auto& [id, one] : all) one->graph_node_->root.reset(), one->graph_node_->loops.clear();
}

static void a_candidate_that_is_no_loop_is_not_allowed_and_without_a_verdict_the_host_decides() {
    StandIn stand_in(Answers{{{"robot-4", {"robot-1", "verified"}}}});
    standin::Host host;
    auto adapter = adapter_of(stand_in.url(), host);
    auto loop = keyframe(1, nullptr), beside = keyframe(2, nullptr), twin = keyframe(3, nullptr), query = keyframe(4, nullptr), later = keyframe(5, nullptr);
    beside->graph_node_->covisible = {loop};
    for (const auto& one : {loop, beside, twin, query}) CHECK_OK(adapter->insert(one));
    CHECK(adapter->sender().flush(forever));
    CHECK(adapter->allows(query, loop));
    CHECK(adapter->allows(query, beside));
    CHECK(!adapter->allows(query, twin));
    CHECK(adapter->allows(later, twin));
    beside->graph_node_->covisible.clear();
}

static void keypoints_come_from_bearings_where_the_camera_is_no_pinhole() {
    standin::Host host;
    stella_vslam::Options<standin::StellaKeyframe> options;
    options.sender.endpoint.url = "http://127.0.0.1:9";
    options.sender.map = "tower";
    options.sender.closing_ms = 0;
    options.camera = {300, 300, 320, 240, 640, 480};
    options.is_perspective = false;
    auto adapter = Adapter::open(options);
    CHECK_OK(adapter);
    auto one = keyframe(1, nullptr);
    const auto [sent, observed] = (*adapter)->keyframe_of(*one);
    CHECK_OK(check(sent));
    // Bearings at 0 to 2.1 rad: those up to 70 degrees are in the pinhole.
    CHECK_EQUAL(sent.features.keypoints.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) CHECK(std::fabs(sent.features.keypoints[i].u - (320 + 300 * std::tan(0.3 * static_cast<double>(i)))) < 0.01);
    CHECK_EQUAL(observed.size(), 6u);
    CHECK_EQUAL(sent.observes.size(), 2u);
    CHECK_EQUAL(sent.map_points.ids.size(), 6u);
    CHECK_EQUAL(sent.bow.weights[0], 0.5);
    CHECK_EQUAL(sent.id, "robot-1");
}

static void fused_landmarks_and_corrections_follow() {
    StandIn stand_in(Answers{});
    standin::Host host;
    auto adapter = adapter_of(stand_in.url(), host);
    auto first = keyframe(1, nullptr), second = keyframe(2, nullptr);
    CHECK_OK(adapter->insert(first));
    adapter->fused(100, 101);
    adapter->culled_landmark(102);
    first->landmarks[0]->erased = first->landmarks[2]->erased = true;
    second->graph_node_->covisible = {first};
    CHECK_OK(adapter->insert(second));
    CHECK_OK(adapter->corrected(std::vector<Shared>{first, second, keyframe(9, nullptr)}, std::vector<std::shared_ptr<standin::Landmark>>{second->landmarks[1], first->landmarks[0]}));
    CHECK_OK(adapter->culled_keyframe(1));
    CHECK_OK(adapter->culled_keyframe(9));
    CHECK(adapter->sender().flush(forever));
    const auto heard = stand_in.heard();
    CHECK_EQUAL(heard.size(), 5u);
    CHECK_EQUAL(nlohmann::json::parse(heard[2].body).dump(), R"({"keyframes":[{"keyframe":"robot-1","observes":[101,104,105,106]}],"removed":[102],"replaced":[[100,101]],"session":"robot"})");
    const auto poses = nlohmann::json::parse(heard[3].body);
    CHECK_EQUAL(poses["keyframes"]["ids"].dump(), R"(["robot-1","robot-2"])");
    CHECK_EQUAL(poses["map_points"]["ids"].dump(), "[201]");
    CHECK_EQUAL(heard[4].method + heard[4].target, "DELETE/v1/maps/tower/keyframes/robot-1");
}

int main() {
    TEST(a_rejected_request_is_finished_and_the_next_one_made);
    TEST(what_the_host_cannot_close_is_not_requested);
    TEST(what_the_host_really_closed_is_confirmed_and_the_next_loop_comes_later);
    TEST(a_candidate_that_is_no_loop_is_not_allowed_and_without_a_verdict_the_host_decides);
    TEST(keypoints_come_from_bearings_where_the_camera_is_no_pinhole);
    TEST(fused_landmarks_and_corrections_follow);
}
