// Stand-ins with the members of ORB-SLAM3's classes that the adapter uses: names alone, no code of theirs.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <revisit/geometry.hpp>

namespace standin {

struct Point2 {
    float x = 0, y = 0;
};
struct Point3 {
    float x = 0, y = 0, z = 1;
};
struct CvKeyPoint {
    Point2 pt;
    float angle = -1;
    int octave = 0;
};

/// As `cv::Mat` of bytes.
struct Matrix {
    int rows = 0, cols = 32;
    std::vector<unsigned char> data;
    template <class T>
    const T* ptr(int row) const {
        return data.data() + static_cast<std::ptrdiff_t>(row) * cols;
    }
};

/// As `cv::Mat` of floats, of 4x4 or 3x1.
struct FloatMatrix {
    int columns = 4;
    std::vector<float> data;
    template <class T>
    T at(int row, int column) const {
        return data[static_cast<std::size_t>(row * columns + column)];
    }
    template <class T>
    T at(int row) const {
        return data[static_cast<std::size_t>(row)];
    }
};

/// As an Eigen vector of floats.
struct Vector3f {
    std::array<float, 3> data{0, 0, 0};
    float operator()(int axis) const { return data[static_cast<std::size_t>(axis)]; }
};

struct Quaternionf {
    float x_ = 0, y_ = 0, z_ = 0, w_ = 1;
    float x() const { return x_; }
    float y() const { return y_; }
    float z() const { return z_; }
    float w() const { return w_; }
};

/// As `Sophus::SE3f`.
struct Rigid {
    Vector3f t;
    Quaternionf q;
    const Vector3f& translation() const { return t; }
    const Quaternionf& unit_quaternion() const { return q; }
};

inline Rigid rigid_of(const revisit::Pose& pose) {
    const auto& q = pose.rotation;
    const auto& t = pose.translation;
    return {{{static_cast<float>(t[0]), static_cast<float>(t[1]), static_cast<float>(t[2])}}, {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}};
}

/// As `g2o::Sim3`.
struct Quaterniond {
    double w_ = 1, x_ = 0, y_ = 0, z_ = 0;
    Quaterniond() = default;
    Quaterniond(double w, double x, double y, double z) : w_(w), x_(x), y_(y), z_(z) {}
    double x() const { return x_; }
    double y() const { return y_; }
    double z() const { return z_; }
    double w() const { return w_; }
};
struct Vector3d {
    std::array<double, 3> data{0, 0, 0};
    Vector3d() = default;
    Vector3d(double x, double y, double z) : data{x, y, z} {}
    double operator()(int axis) const { return data[static_cast<std::size_t>(axis)]; }
};
struct Sim3 {
    Quaterniond r;
    Vector3d t;
    double s = 1;
    Sim3() = default;
    Sim3(const Quaterniond& r_, const Vector3d& t_, double s_) : r(r_), t(t_), s(s_) {}
    const Quaterniond& rotation() const { return r; }
    const Vector3d& translation() const { return t; }
    const double& scale() const { return s; }
    /// `map` of g2o: s * (r * x) + t.
    revisit::Vector3 map(const revisit::Vector3& x) const { return revisit::Similarity{s, {t(0), t(1), t(2)}, {r.x(), r.y(), r.z(), r.w()}} * x; }
};

struct Map {
    unsigned long id = 0;
    bool imu = false, bad = false;
    unsigned long GetId() const { return id; }
    bool isImuInitialized() const { return imu; }
    bool IsBad() const { return bad; }
};

struct MapPoint {
    unsigned long mnId = 0;
    long mnFirstKFid = 0;
    Map* map = nullptr;
    Vector3f position;
    bool bad = false;
    bool isBad() const { return bad; }
    Vector3f GetWorldPos() const { return position; }
    Map* GetMap() const { return map; }
};

/// The equidistant fisheye: the angle from the axis is the radius over the focal length. `type` 1 is KB8, 0 a pinhole.
struct Camera {
    unsigned type = 0;
    float f = 250, cx = 320, cy = 240;
    unsigned GetType() const { return type; }
    Point3 unproject(const Point2& at) const {
        const double x = (at.x - cx) / f, y = (at.y - cy) / f, angle = std::hypot(x, y);
        const double scale = angle > 1e-9 ? std::tan(angle) / angle : 1;
        return {static_cast<float>(x * scale), static_cast<float>(y * scale), angle < 1.57 ? 1.0f : -1.0f};
    }
};

struct KeyFrame {
    unsigned long mnId = 0;
    double mTimeStamp = 0;
    float fx = 250, fy = 250, cx = 320, cy = 240;
    int mnMaxX = 640, mnMaxY = 480;
    std::vector<CvKeyPoint> mvKeys, mvKeysUn;
    Matrix mDescriptors;
    std::map<unsigned, double> mBowVec;
    Camera* mpCamera = nullptr;
    Map* map = nullptr;
    Rigid pose;
    std::vector<MapPoint*> matches;
    std::vector<KeyFrame*> covisible;
    bool bad = false;

    bool isBad() const { return bad; }
    Map* GetMap() const { return map; }
    Rigid GetPoseInverse() const { return pose; }
    std::vector<MapPoint*> GetMapPointMatches() const { return matches; }
    std::vector<KeyFrame*> GetBestCovisibilityKeyFrames(const int& count) const {
        return {covisible.begin(), covisible.begin() + std::min<std::ptrdiff_t>(count, static_cast<std::ptrdiff_t>(covisible.size()))};
    }
};

}  // namespace standin
