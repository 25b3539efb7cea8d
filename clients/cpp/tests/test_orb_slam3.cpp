// The ORB-SLAM3 adapter on stand-ins, against the real server; what it sends of a merge, against a stand-in for it.
#include <atomic>
#include <future>
#include <random>

#include <nlohmann/json.hpp>
#include <revisit/orb_slam3.hpp>

#include "check.hpp"
#include "orb_slam3_stand_in.hpp"
#include "server.hpp"
#include "stand_in.hpp"

using namespace revisit;
using namespace std::chrono_literals;
using Adapter = orb_slam3::Adapter<standin::KeyFrame, standin::MapPoint>;
using Options = orb_slam3::Options<standin::KeyFrame>;

constexpr auto forever = 250s;
static std::mt19937 chance(28);
static double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(chance); }

static Pose any_pose() {
    std::normal_distribution<double> normal;
    return {{uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)}, normalized({normal(chance), normal(chance), normal(chance), normal(chance)})};
}

static bool is_near(const Vector3& a, const Vector3& b, double limit) {
    return std::fabs(a[0] - b[0]) < limit && std::fabs(a[1] - b[1]) < limit && std::fabs(a[2] - b[2]) < limit;
}

/// A host: keyframes along a corridor, that read a plate and see the same words everywhere.
struct Host {
    standin::Map map{0, false, false}, other{1, false, false};
    standin::Camera camera;
    std::vector<std::unique_ptr<standin::KeyFrame>> keyframes;
    std::vector<std::unique_ptr<standin::MapPoint>> points;
    std::map<const standin::KeyFrame*, std::string> plates;

    standin::KeyFrame& add(double x, double seconds, const std::string& plate, std::size_t features = 30) {
        keyframes.push_back(std::make_unique<standin::KeyFrame>());
        auto& keyframe = *keyframes.back();
        keyframe.mnId = keyframes.size();
        keyframe.mTimeStamp = seconds;
        keyframe.pose.t.data[0] = static_cast<float>(x);
        keyframe.map = &map;
        keyframe.mpCamera = &camera;
        keyframe.mBowVec = {{3, 0.3}, {17, 0.3}, {42, 0.4}};
        for (std::size_t i = 0; i < features; ++i) {
            keyframe.mvKeys.push_back({{static_cast<float>(uniform(0, 640)), static_cast<float>(uniform(0, 480))}, i % 5 == 0 ? -1.0f : 90.0f, static_cast<int>(i % 8)});
            for (int k = 0; k < 32; ++k) keyframe.mDescriptors.data.push_back(static_cast<unsigned char>(chance()));
            auto* point = i % 3 == 2 ? nullptr : &point_of(keyframe, i);
            keyframe.matches.push_back(point);
        }
        keyframe.mDescriptors.rows = static_cast<int>(features);
        keyframe.mvKeysUn = keyframe.mvKeys;
        plates[&keyframe] = plate;
        return keyframe;
    }

    standin::MapPoint& point_of(const standin::KeyFrame& keyframe, std::size_t i) {
        points.push_back(std::make_unique<standin::MapPoint>());
        auto& point = *points.back();
        point.mnId = points.size();
        point.mnFirstKFid = static_cast<long>(keyframe.mnId);
        point.map = &map;
        point.position.data = {keyframe.pose.t.data[0], 0.1f * static_cast<float>(i), 2};
        return point;
    }

    std::vector<Detection> read(const standin::KeyFrame& keyframe) {
        Detection detection;
        detection.class_name = "door_number";
        detection.confidence = 0.9;
        detection.box = {300, 200, 340, 220};
        detection.position = Vector3{keyframe.pose.t.data[0], 0, 2};
        detection.text = plates[&keyframe];
        return {detection};
    }
};

static std::unique_ptr<Adapter> adapter_of(Host& host, const std::string& url, std::size_t places = 0) {
    Options options;
    options.sender.endpoint.url = url;
    options.sender.map = "tower";
    options.sender.closing_ms = 0;
    options.sender.first_wait_ms = 1;
    if (places > 0) {
        options.sender.makes_map = false;
        options.sender.queue_items = places;
        options.sender.reserved_items = 0;
    }
    options.robot = "robot-7";
    // As long as a slow machine needs: the test is about what comes, not when.
    options.longest_wait = 250s;
    options.detections = [&host](standin::KeyFrame& keyframe) { return host.read(keyframe); };
    auto adapter = Adapter::open(options);
    CHECK_OK(adapter);
    return std::move(*adapter);
}

// What bag of words alone would offer is all three keyframes; the signs say which.
static void the_host_is_offered_the_loop_and_not_the_twin() {
    Server server;
    Host host;
    auto adapter = adapter_of(host, server.url());
    auto& first = host.add(0, 1, "901");
    auto& twin = host.add(40, 60, "910");
    auto& again = host.add(3, 120, "Room 901");
    for (auto* keyframe : {&first, &twin, &again}) CHECK_OK(adapter->insert(keyframe));
    std::vector<standin::KeyFrame*> loops{&twin}, merges{&twin};
    CHECK(adapter->candidates(&again, loops, merges, 3));
    CHECK_EQUAL(loops.size(), 1u);
    CHECK(loops[0] == &first);
    CHECK(merges.empty());
    CHECK_EQUAL(adapter->stats().rejected, 1u);
    // The host verified and closed it, optimised, and took it back.
    CHECK_OK(adapter->closed(&again, &first));
    again.pose.t.data[0] = 0.25f;
    CHECK_OK(adapter->corrected(std::vector<standin::KeyFrame*>{&first, &again}, std::vector<standin::MapPoint*>{host.points[0].get()}));
    CHECK(adapter->sender().flush(forever));
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    const auto listed = client->call("list_loops", {{{"map", "tower"}}, {}, {}, {}});
    CHECK_OK(listed);
    CHECK_EQUAL(listed->json["items"].items().size(), 1u);
    CHECK_EQUAL(client->call("get_keyframe", {{{"map", "tower"}, {"keyframe", "robot-7.m0-3"}}, {}, {}, {}})->json["pose"]["translation"]["x"].number(), 0.25);
    CHECK_OK(adapter->reopened(&again, &first));
    CHECK_OK(adapter->culled(&twin));
    CHECK(adapter->sender().flush(forever));
    CHECK_EQUAL(client->call("list_loops", {{{"map", "tower"}}, {}, {}, {}})->json["items"].items().size(), 0u);
    CHECK_EQUAL(client->call("get_map", {{{"map", "tower"}}, {}, {}, {}})->json["keyframes"].integer(), 2);
    CHECK_EQUAL(adapter->sender().stats().refused, 0u);
}

static void a_candidate_of_another_map_is_offered_for_a_merge() {
    Server server;
    Host host;
    auto adapter = adapter_of(host, server.url());
    auto& first = host.add(0, 1, "901");
    auto& again = host.add(0, 120, "901");
    again.map = &host.other;
    CHECK_OK(adapter->insert(&first));
    CHECK_OK(adapter->insert(&again));
    std::vector<standin::KeyFrame*> loops, merges;
    CHECK(adapter->candidates(&again, loops, merges, 3));
    CHECK(loops.empty());
    CHECK_EQUAL(merges.size(), 1u);
    CHECK(merges[0] == &first);
    // A map that the host has given up is not offered.
    host.map.bad = true;
    CHECK(adapter->candidates(&again, loops, merges, 3));
    CHECK(merges.empty());
}

static void the_host_decides_where_no_verdict_comes() {
    Host host;
    auto adapter = adapter_of(host, "http://127.0.0.1:9");
    auto& first = host.add(0, 1, "901");
    CHECK_OK(adapter->insert(&first));
    while (!adapter->sender().stats().unreachable) std::this_thread::sleep_for(1ms);
    std::vector<standin::KeyFrame*> loops, merges;
    CHECK(!adapter->candidates(&first, loops, merges, 3));
    CHECK_EQUAL(adapter->stats().left_to_host, 1u);
    // Refused at once, and so no verdict is waited for.
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{422, R"({"code":"invalid"})", "", false, false}; });
    auto refused = adapter_of(host, stand_in.url());
    CHECK_OK(refused->insert(&first));
    CHECK(!refused->candidates(&first, loops, merges, 3));
}

static void fused_and_culled_points_follow_with_the_next_keyframe() {
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{200, R"({"verdict":"no_loop"})", "", false, false}; });
    Host host;
    auto adapter = adapter_of(host, stand_in.url());
    auto& first = host.add(0, 1, "901", 6);
    CHECK_OK(adapter->insert(&first));
    auto& second = host.add(0, 2, "901", 6);
    second.covisible = {&first};
    // Local mapping fuses point 1 into 5 and culls 2, before the second keyframe reaches loop closing.
    auto &kept = *host.points[4], &fused = *host.points[0], &culled = *host.points[1];
    adapter->fused(&fused, &kept);
    fused.bad = true;
    first.matches[0] = &kept;
    adapter->culled(&culled);
    culled.bad = true;
    CHECK_OK(adapter->insert(&second));
    auto& third = host.add(0, 3, "901", 6);
    third.covisible = {&first, &second};
    CHECK_OK(adapter->insert(&third));
    adapter->sender().flush(forever);
    CHECK_OK(adapter->merged(1, 0, {1, {1, 0, 0}, {}}));
    CHECK(adapter->sender().flush(forever));
    std::vector<nlohmann::json> updates;
    std::string merge;
    for (const auto& request : stand_in.heard()) {
        if (request.target == "/v1/maps/tower/observations") updates.push_back(nlohmann::json::parse(request.body));
        if (request.target == "/v1/maps/tower/sessions/robot-7.m1/merge") merge = request.body;
    }
    // Once: the third keyframe found nothing new.
    CHECK_EQUAL(updates.size(), 1u);
    CHECK_EQUAL(updates[0].dump(), R"({"keyframes":[{"keyframe":"robot-7.m0-1","observes":[3,4,5]}],"removed":[2],"replaced":[[1,5]],"session":"robot-7.m0"})");
    CHECK_EQUAL(nlohmann::json::parse(merge)["into"], "robot-7.m0");
}

// Local mapping finds that the second keyframe's points are the first one's: the server sees one place, and no loop.
static void what_the_host_fused_is_no_loop_on_the_server() {
    Server server;
    Host host;
    auto adapter = adapter_of(host, server.url());
    auto& first = host.add(0, 1, "901");
    auto& second = host.add(0.5, 2, "901");
    CHECK_OK(adapter->insert(&first));
    CHECK_OK(adapter->insert(&second));
    std::vector<standin::KeyFrame*> loops, merges;
    CHECK(adapter->candidates(&second, loops, merges, 3));
    CHECK_EQUAL(loops.size(), 1u);
    for (std::size_t i = 0; i < second.matches.size(); ++i) {
        auto *old = second.matches[i], *by = first.matches[i];
        if (old == nullptr) continue;
        adapter->fused(old, by);
        // As ORB-SLAM3 may: a bad point is made bad again.
        adapter->culled(old);
        old->bad = true;
        second.matches[i] = by;
    }
    auto& culled = *first.matches[0];
    adapter->culled(&culled);
    adapter->culled(&culled);
    culled.bad = true;
    first.matches[0] = second.matches[0] = nullptr;
    auto& third = host.add(40, 60, "910");
    third.covisible = {&second, &first};
    CHECK_OK(adapter->insert(&third));
    CHECK(adapter->sender().flush(forever));
    CHECK_EQUAL(adapter->sender().stats().refused, 0u);
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    const auto listed = client->call("list_covisible", {{{"map", "tower"}, {"keyframe", "robot-7.m0-2"}}, {}, {}, {}});
    CHECK_OK(listed);
    CHECK_EQUAL(listed->json["items"].items().size(), 1u);
    CHECK_EQUAL(listed->json["items"].items()[0]["keyframe"].text(), "robot-7.m0-1");
    CHECK_EQUAL(listed->json["items"].items()[0]["shared"].integer(), 19);
    const auto verdict = client->query_loop("tower", "robot-7.m0-2");
    CHECK_OK(verdict);
    CHECK(verdict->decision == Decision::no_loop);
    const auto read = client->call("get_keyframe", {{{"map", "tower"}, {"keyframe", "robot-7.m0-1"}}, {}, {}, {}});
    CHECK_OK(read);
    const auto& observes = read->json["observes"].items();
    CHECK_EQUAL(observes.size(), 19u);
    for (const auto& point : observes) CHECK(point.integer() != static_cast<std::int64_t>(culled.mnId));
}

static void changes_that_a_full_queue_refused_come_with_the_next_keyframe() {
    std::promise<void> begun, release;
    auto released = release.get_future().share();
    std::atomic<bool> is_first{true};
    StandIn stand_in([&](const HeardRequest&) {
        if (is_first.exchange(false)) begun.set_value();
        released.wait();
        return GivenAnswer{200, R"({"verdict":"no_loop"})", "", false, false};
    });
    Host host;
    auto adapter = adapter_of(host, stand_in.url(), 1);
    auto& first = host.add(0, 1, "901", 6);
    CHECK_OK(adapter->insert(&first));
    begun.get_future().wait();
    auto& second = host.add(0, 2, "901", 6);
    second.covisible = {&first};
    adapter->fused(host.points[0].get(), host.points[4].get());
    first.matches[0] = host.points[4].get();
    // It takes the one place.
    CHECK(adapter->insert(&second).error().code == Code::queue_full);
    release.set_value();
    CHECK(adapter->sender().flush(forever));
    adapter->culled(host.points[1].get());
    auto& third = host.add(0, 3, "901", 6);
    third.covisible = {&first};
    while (!adapter->insert(&third)) CHECK(adapter->sender().flush(forever));
    CHECK(adapter->sender().flush(forever));
    std::vector<std::string> updates;
    for (const auto& request : stand_in.heard())
        if (request.target == "/v1/maps/tower/observations") updates.push_back(nlohmann::json::parse(request.body).dump());
    CHECK(!updates.empty());
    CHECK_EQUAL(updates[0], R"({"keyframes":[{"keyframe":"robot-7.m0-1","observes":[3,4,5]}],"removed":[2],"replaced":[[1,5]],"session":"robot-7.m0"})");
}

// A fisheye's keypoints, taken through the adapter, are where a pinhole of the same focal length sees the same rays.
static void a_fisheye_becomes_a_pinhole() {
    Host host;
    auto adapter = adapter_of(host, "http://127.0.0.1:9");
    host.camera.type = 1;
    auto& keyframe = host.add(0, 1, "901", 200);
    // A stereo rig: features of the right camera come after those of the left one, in descriptors and matches alone.
    for (int i = 0; i < 10; ++i) {
        keyframe.matches.push_back(i == 0 ? keyframe.matches[0] : &host.point_of(keyframe, 0));
        for (int k = 0; k < 32; ++k) keyframe.mDescriptors.data.push_back(7);
    }
    keyframe.mDescriptors.rows = 210;
    // Two beyond the angle: one at 80 degrees, one behind the camera.
    keyframe.mvKeys[3].pt = {320 + 250 * 1.396f, 240};
    keyframe.mvKeys[4].pt = {320 + 250 * 1.75f, 240};
    const auto [sent, observed] = adapter->keyframe_of(keyframe, "k", "s");
    CHECK_OK(check(sent));
    CHECK(sent.features.keypoints.size() <= 198);
    CHECK(sent.features.keypoints.size() > 100);
    std::size_t at = 0;
    for (std::size_t i = 0; i < 200; ++i) {
        const double x = (keyframe.mvKeys[i].pt.x - 320) / 250, y = (keyframe.mvKeys[i].pt.y - 240) / 250, angle = std::hypot(x, y);
        if (angle > 1.2217) continue;
        const auto& found = sent.features.keypoints[at];
        CHECK(std::fabs(found.u - (320 + 250 * x * std::tan(angle) / angle)) < 0.05);
        CHECK(std::fabs(found.v - (240 + 250 * y * std::tan(angle) / angle)) < 0.05);
        CHECK_EQUAL(sent.features.map_points[at], keyframe.matches[i] ? static_cast<std::int64_t>(keyframe.matches[i]->mnId) : -1);
        CHECK_EQUAL(sent.features.descriptors[at * 32 + 5], keyframe.mDescriptors.data[i * 32 + 5]);
        CHECK_EQUAL(std::isnan(found.angle_deg), i % 5 == 0);
        ++at;
    }
    CHECK_EQUAL(at, sent.features.keypoints.size());
    // No observation is lost with a keypoint, and none is counted twice.
    std::vector<std::int64_t> all = sent.observes;
    for (const auto point : sent.features.map_points)
        if (point >= 0) all.push_back(point);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    CHECK(all == observed);
    auto ids = sent.map_points.ids;
    std::sort(ids.begin(), ids.end());
    CHECK(std::adjacent_find(ids.begin(), ids.end()) == ids.end());
}

static void gravity_points_down_in_the_camera() {
    Host host;
    auto adapter = adapter_of(host, "http://127.0.0.1:9");
    auto& keyframe = host.add(0, 1, "901");
    CHECK(!adapter->keyframe_of(keyframe, "k", "s").first.gravity);
    host.map.imu = true;
    for (int i = 0; i < 100; ++i) {
        const Pose pose = any_pose();
        keyframe.pose = standin::rigid_of(pose);
        const auto sent = adapter->keyframe_of(keyframe, "k", "s").first;
        CHECK(is_near(rotate(pose.rotation, *sent.gravity), {0, 0, -1}, 1e-5));
        CHECK_OK(check(sent));
    }
}

// Host types convert both ways, and g2oScw sees a point of the candidate's map where the query's camera does.
static void g2o_scw_is_composed_as_the_host_composes_it() {
    for (int i = 0; i < 500; ++i) {
        const Pose map_from_candidate = any_pose(), pose = any_pose();
        const Similarity candidate_from_query{std::exp(uniform(-1, 1)), pose.translation, pose.rotation};
        standin::KeyFrame candidate;
        candidate.pose = standin::rigid_of(map_from_candidate);
        const auto scw = Adapter::g2o_scw<standin::Sim3>(&candidate, candidate_from_query);
        const Vector3 in_query{uniform(-3, 3), uniform(-3, 3), uniform(1, 9)};
        const Vector3 in_map = map_from_candidate * (candidate_from_query * in_query);
        CHECK(is_near(scw.map(in_map), in_query, 1e-4));
        // As `gScm * gSmw` of the host: from the matched keyframe to the current one, after from the map to the matched one.
        const auto by_host = inverse(candidate_from_query) * similarity_of(inverse(map_from_candidate));
        CHECK(is_near(by_host * in_map, scw.map(in_map), 1e-4));
        CHECK(is_near(host::similarity_from(scw) * in_map, scw.map(in_map), 1e-9));

        // A Sophus pose, an OpenCV matrix and an Eigen one say the same.
        const auto m = matrix_of(pose.rotation);
        standin::FloatMatrix matrix;
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t column = 0; column < 3; ++column) matrix.data.push_back(static_cast<float>(m[3 * row + column]));
            matrix.data.push_back(static_cast<float>(pose.translation[row]));
        }
        const Vector3 point{1, 2, 3};
        const auto eigen = [&](int row, int column) { return static_cast<double>(matrix.at<float>(row, column)); };
        CHECK(is_near(host::pose_from(matrix) * point, pose * point, 1e-4));
        CHECK(is_near(host::pose_from(standin::rigid_of(pose)) * point, pose * point, 1e-4));
        CHECK(is_near(host::pose_from(eigen) * point, pose * point, 1e-4));

        // Two maps become one: a point keeps its place relative to the camera.
        const Similarity camera_from_session = similarity_of(inverse(any_pose()));
        const Similarity moved = host::into_from_session(host::similarity_from(scw), camera_from_session);
        const Vector3 in_session = inverse(camera_from_session) * in_query;
        CHECK(is_near(moved * in_session, inverse(host::similarity_from(scw)) * in_query, 1e-6));
    }
}

int main() {
    TEST(the_host_is_offered_the_loop_and_not_the_twin);
    TEST(a_candidate_of_another_map_is_offered_for_a_merge);
    TEST(the_host_decides_where_no_verdict_comes);
    TEST(fused_and_culled_points_follow_with_the_next_keyframe);
    TEST(what_the_host_fused_is_no_loop_on_the_server);
    TEST(changes_that_a_full_queue_refused_come_with_the_next_keyframe);
    TEST(a_fisheye_becomes_a_pinhole);
    TEST(gravity_points_down_in_the_camera);
    TEST(g2o_scw_is_composed_as_the_host_composes_it);
}
