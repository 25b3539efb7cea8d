"""A robot whose map fuses and culls points after it has sent its keyframes, besides all else that it writes."""

from robots import Robot


class ObservingRobot(Robot):
    """Changes what its keyframes observe, too."""

    def observations(self):
        """Lists a keyframe's points anew, or fuses or culls one that keyframes share."""
        mine = self.alive("keyframe")
        # One in doubt may observe the point, or not.
        if not mine or any(key[0] == "keyframe" for key in self.frozen):
            return self.put()
        now, key = self.now(), self.chance.choice(mine)
        observed = now[key]["observes"]
        if len(observed) < 2:
            return self.put()
        body, changed = {"session": self.robot}, {}
        what = self.chance.choice(("list", "fuse", "cull"))
        if what == "list":
            kept = self.chance.sample(observed, len(observed) // 2 + 1)
            body["keyframes"] = [{"keyframe": key[2], "observes": kept}]
            changed[key] = set(kept)
        else:
            gone, stays = self.chance.sample(observed, 2)
            body |= {"replaced": [[gone, stays]]} if what == "fuse" else {"removed": [gone]}
            for each in mine:
                if gone in now[each]["observes"]:
                    changed[each] = set(now[each]["observes"]) - {gone} | ({stays} if what == "fuse" else set())
        states = {}
        for each, points in changed.items():
            # Positions of points, and points of detections, follow: they are not compared afterwards.
            states[each] = {name: value for name, value in now[each].items() if name not in ("map_points", "detections")}
            states[each]["observes"] = sorted(points)
        self.send("observations", states, "POST", f"/v1/maps/{self.shared}/observations", body)
