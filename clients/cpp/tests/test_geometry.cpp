// Laws of poses and similarities, over random ones.
#include <random>

#include <revisit/geometry.hpp>

#include "check.hpp"

using namespace revisit;

static std::mt19937 chance(20260);

static double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(chance); }

static Quaternion any_rotation() {
    std::normal_distribution<double> normal;
    return normalized({normal(chance), normal(chance), normal(chance), normal(chance)});
}

static Vector3 any_point() { return {uniform(-20, 20), uniform(-20, 20), uniform(-20, 20)}; }
static Pose any_pose() { return {any_point(), any_rotation()}; }
static Similarity any_similarity() { return {std::exp(uniform(-1, 1)), any_point(), any_rotation()}; }

static void close_to(const Vector3& a, const Vector3& b) {
    for (std::size_t axis = 0; axis < 3; ++axis) CHECK(std::fabs(a[axis] - b[axis]) < 1e-9);
}

constexpr int rounds = 1000;

static void composing_is_applying_one_after_the_other() {
    for (int i = 0; i < rounds; ++i) {
        const auto a = any_similarity(), b = any_similarity(), c = any_similarity();
        const auto point = any_point();
        close_to((a * b) * point, a * (b * point));
        close_to(((a * b) * c) * point, (a * (b * c)) * point);
        const auto p = any_pose(), q = any_pose();
        close_to((p * q) * point, p * (q * point));
        close_to(similarity_of(p) * point, p * point);
    }
}

static void an_inverse_undoes() {
    for (int i = 0; i < rounds; ++i) {
        const auto a = any_similarity();
        const auto p = any_pose();
        const auto point = any_point();
        close_to(inverse(a) * (a * point), point);
        close_to((a * inverse(a)) * point, point);
        close_to(inverse(p) * (p * point), point);
    }
}

static void a_matrix_and_its_quaternion_rotate_alike() {
    for (int i = 0; i < rounds; ++i) {
        // Half turns too, where the scalar part vanishes.
        Quaternion q = any_rotation();
        if (i % 4 == 0) q = normalized({i % 8 == 0 ? 1.0 : 1e-9, i % 3 == 0 ? 1.0 : 0.0, 1e-12, 0});
        const auto m = matrix_of(q);
        const auto point = any_point();
        const Vector3 turned{m[0] * point[0] + m[1] * point[1] + m[2] * point[2], m[3] * point[0] + m[4] * point[1] + m[5] * point[2], m[6] * point[0] + m[7] * point[1] + m[8] * point[2]};
        close_to(rotate(q, point), turned);
        close_to(rotate(quaternion_of(m), point), turned);
    }
}

// A landmark that both cameras see: the query's map has drifted, the candidate's is right. After the loop the query's camera must see
// it where it does see it.
static void a_loop_puts_the_query_where_it_sees_what_the_candidate_saw() {
    for (int i = 0; i < rounds; ++i) {
        const Pose map_from_candidate = any_pose();
        const Similarity candidate_from_query = any_similarity();
        const Vector3 in_query = any_point();
        const Vector3 in_map = map_from_candidate * (candidate_from_query * in_query);
        close_to(corrected_map_from_query(map_from_candidate, candidate_from_query) * in_query, in_map);
        close_to(query_from_map(map_from_candidate, candidate_from_query) * in_map, in_query);
    }
}

// The host drops the scale of `g2oScw` and divides the translation by it: the camera's centre stays.
static void dropping_the_scale_keeps_the_cameras_centre() {
    for (int i = 0; i < rounds; ++i) {
        const Similarity camera_from_map = any_similarity();
        const Vector3 centre = inverse(camera_from_map) * Vector3{0, 0, 0};
        close_to(inverse(pose_of(camera_from_map)) * Vector3{0, 0, 0}, centre);
        close_to(rotate(pose_of(camera_from_map).rotation, {0, 0, 1}), rotate(camera_from_map.rotation, {0, 0, 1}));
    }
}

int main() {
    TEST(composing_is_applying_one_after_the_other);
    TEST(an_inverse_undoes);
    TEST(a_matrix_and_its_quaternion_rotate_alike);
    TEST(a_loop_puts_the_query_where_it_sees_what_the_candidate_saw);
    TEST(dropping_the_scale_keeps_the_cameras_centre);
}
