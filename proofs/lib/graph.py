"""Reads a pose graph with gtsam, and compares it with what the loop's query answered, in gtsam's own terms."""

import json
import sys
from pathlib import Path

import gtsam
import numpy as np


def judge(work: Path) -> None:
    graph, poses = gtsam.readG2o(str(work / "drive.g2o"), True)
    steps = int((work / "poses").read_text())
    edges = [graph.at(place) for place in range(graph.size())]
    joins = {tuple(edge.keys()): edge for edge in edges}
    loops = [edge for (one, other), edge in joins.items() if other != one + 1]
    assert (poses.size(), len(edges), len(loops)) == (2 * steps, 2 * (steps - 1) + 1, 1), (poses.size(), len(edges), len(loops))
    # Neighbours stand as far apart as the poses say.
    assert all(edge.error(poses) < 1e-9 for edge in edges if edge not in loops)

    (loop,) = loops
    answer = json.loads((work / "answer.json").read_text())
    geometry = next(c["geometry"] for c in answer["candidates"] if c["keyframe"] == answer["best"])
    found = geometry["candidate_from_query"]
    q, t = found["rotation"], found["translation"]
    pose = gtsam.Pose3(gtsam.Rot3.Quaternion(q["w"], q["x"], q["y"], q["z"]), np.array([t["x"], t["y"], t["z"]]))
    assert loop.measured().equals(pose, 1e-9), (loop.measured(), pose)
    # gtsam: rotation first, in the frame of the second vertex. What the covariance says of a small move about the
    # candidate's axes must cost the same there.
    covariance = np.array(geometry["covariance"]).reshape(6, 6)
    rng, costs = np.random.default_rng(1), []
    for _ in range(20):
        move = rng.normal(0, 1e-4, 6)
        moved = gtsam.Pose3(gtsam.Rot3.Expmap(move[3:]).compose(pose.rotation()), pose.translation() + move[:3])
        two = gtsam.Values()
        one, other = loop.keys()
        two.insert(one, gtsam.Pose3())
        two.insert(other, moved)
        costs.append(2 * loop.error(two) / (move @ np.linalg.solve(covariance, move)))
    assert np.allclose(costs, 1, atol=2e-2), costs

    # Two robots in frames of their own: one optimiser's step joins them.
    graph.add(gtsam.PriorFactorPose3(0, poses.atPose3(0), gtsam.noiseModel.Isotropic.Sigma(6, 1e-6)))
    before = graph.error(poses)
    joined = gtsam.LevenbergMarquardtOptimizer(graph, poses).optimize()
    after = graph.error(joined)
    assert before > 100 and after < 1e-3, (before, after)
    # The second robot starts 0.3 m beside the first, in one frame now.
    apart = joined.atPose3(0).translation() - joined.atPose3(steps).translation()
    assert abs(np.linalg.norm(apart) - 0.3) < 0.1, apart
    print(
        f"gtsam reads g2o: {poses.size()} poses, {len(edges)} edges; a move costs what the covariance says "
        f"({min(costs):.4f} to {max(costs):.4f} of it); optimised from {before:.0f} to {after:.1e}"
    )


if __name__ == "__main__":
    judge(Path(sys.argv[1]))
