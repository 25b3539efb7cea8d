"""One method an operation. Made from the API document by tools/generate.py: do not edit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import models
from .call import Call, segment
from .packing import packed


class Operations:
    """Operations that block until they are answered."""

    def _call(self, call: Call) -> Any:
        raise NotImplementedError

    def healthz(self) -> models.Health:
        """Check liveness. Returns 200 while the process is alive."""
        return self._call(Call("GET", "/healthz", answer=models.Health))

    def get_metrics(self) -> str:
        """Read the metrics. In the OpenMetrics format, for Prometheus."""
        return self._call(Call("GET", "/metrics", answer=str))

    def get_document(self) -> dict[str, Any]:
        """Read this document. As JSON; `revisit openapi` prints it too."""
        return self._call(Call("GET", "/openapi.json", answer=dict))

    def readyz(self) -> models.Health:
        """Check readiness for requests. Returns 200 once the database is open, 503 after shutdown begins.
        Maps are loaded on first use. A server whose disk refuses writes still answers questions: it
        returns 200 with `degraded`, and why.
        """
        return self._call(Call("GET", "/readyz", answer=models.Health))

    def list_backups(self, *, limit: int | None = None, cursor: str | None = None) -> models.BackupList:
        """List backups. Newest first, paged."""
        return self._call(Call("GET", "/v1/backups", query={"limit": limit, "cursor": cursor}, answer=models.BackupList))

    def take_backup(self, body: models.BackupBody | Mapping[str, Any]) -> models.Backup:
        """Take a backup. Creates a complete copy of the database in the folder given by `revisit serve
        --backups`. It is verified and on disk when the response is sent. A verified backup is one that
        `revisit restore` accepts. If the database has faults, the copy is kept as `latest.damaged`, and
        the response is 500 (`backup_not_verified`) with the first faults. An existing id returns the
        existing backup. Only one backup runs at a time; another request receives 503. The oldest
        backups beyond the configured number are deleted.
        """
        return self._call(Call("POST", "/v1/backups", body=body, answer=models.Backup))

    def delete_backup(self, id: str) -> None:
        """Delete a backup. Its two files are removed from the folder given by `revisit serve --backups`."""
        return self._call(Call("DELETE", f"/v1/backups/{segment(id)}"))

    def list_keys(self, *, limit: int | None = None, cursor: str | None = None) -> models.KeyList:
        """List keys. In order of creation, including revoked ones. Secrets are not stored."""
        return self._call(Call("GET", "/v1/keys", query={"limit": limit, "cursor": cursor}, answer=models.KeyList))

    def create_key(self, body: models.KeyBody | Mapping[str, Any]) -> models.KeyView:
        """Create a key. The response contains the secret, which is shown only once. From the first key on,
        every request needs a key, including the viewer's. The first key must therefore be an
        administrator's: with `admin`, for every map, without an expiry (else 409). `revisit keys
        create` creates keys directly in the database, to regain access.
        """
        return self._call(Call("POST", "/v1/keys", body=body, answer=models.KeyView))

    def get_own_key(self) -> models.KeyView:
        """Read the key that asks. What it may do, and with which maps. A server that requires no key
        answers 404.
        """
        return self._call(Call("GET", "/v1/keys/me", answer=models.KeyView))

    def revoke_key(self, id: str, *, last_admin: bool | None = None) -> None:
        """Revoke a key. The key is rejected from now on and stays in the list. Revoking it again changes
        nothing. The last administrator key is revoked only with `last_admin=true` (else 409).
        """
        return self._call(Call("DELETE", f"/v1/keys/{segment(id)}", query={"last_admin": last_admin}))

    def locate(self, body: models.LocateBody | Mapping[str, Any]) -> models.LocateAnswer:
        """Find where a keyframe was taken. The keyframe need not have a pose: it is held against one,
        several or all maps that the key may query. The answer is `located` only where the confidence is
        at least 0.99. Where several places fit, it is `ambiguous`, and `look_for` names signs that
        would tell them apart; else it is `unknown`. The question stores nothing and calls no model. At
        most 64 maps are asked, and geometry looks at 20 pairs of keyframes at most.
        """
        return self._call(Call("POST", "/v1/locate", body=body, answer=models.LocateAnswer))

    def list_maps(self, *, limit: int | None = None, cursor: str | None = None) -> models.MapList:
        """List maps. Sorted by id, paged; only maps that the key covers."""
        return self._call(Call("GET", "/v1/maps", query={"limit": limit, "cursor": cursor}, answer=models.MapList))

    def get_map(self, map: str, *, detail: str | None = None) -> models.MapView:
        """Read a map. Includes every setting in force; with `?detail=brief` only those that differ from
        their defaults.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}", query={"detail": detail}, answer=models.MapView))

    def put_map(self, map: str, body: models.MapBody | Mapping[str, Any], *, detail: str | None = None) -> models.MapView:
        """Create a map. Sending the same body again changes nothing and returns 200; a different body
        under the same id is a conflict. With a `base` the map begins as a copy of a release or of
        another map, and the answer comes when all of it is on disk; the key must have `read` for that.
        With `?detail=brief` the answer lists only the settings that differ from their defaults.
        """
        return self._call(Call("PUT", f"/v1/maps/{segment(map)}", query={"detail": detail}, body=body, answer=models.MapView))

    def delete_map(self, map: str) -> None:
        """Delete a map. Deletes everything in it."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}"))

    def patch_map(self, map: str, body: models.MapPatchBody | Mapping[str, Any], *, detail: str | None = None) -> models.MapView:
        """Change a map. Omitted members keep their values; `settings` changes only the settings that it
        contains.
        """
        return self._call(Call("PATCH", f"/v1/maps/{segment(map)}", query={"detail": detail}, body=body, answer=models.MapView))

    def list_anchors(self, map: str, *, class_: str | None = None, text: str | None = None, state: str | None = None, merged: bool | None = None, prior: bool | None = None, limit: int | None = None, cursor: str | None = None) -> models.AnchorList:
        """Search anchors. Oldest first, paged. Merged anchors are omitted unless requested."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors", query={"class": class_, "text": text, "state": state, "merged": merged, "prior": prior, "limit": limit, "cursor": cursor}, answer=models.AnchorList))

    def get_anchor(self, map: str, anchor: str) -> models.Anchor:
        """Read an anchor. Returns its readings, its position in each session's frame and the anchors that
        match it.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", answer=models.Anchor))

    def put_prior_anchor(self, map: str, anchor: str, body: models.PriorBody | Mapping[str, Any]) -> models.Anchor:
        """Put a prior anchor. A sign that a floor plan shows, known before any robot has seen it. It
        matches what robots read, aligns their sessions to the plan, and closes no loop by itself. A
        plan's frame is a session that no robot drives.
        """
        return self._call(Call("PUT", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", body=body, answer=models.Anchor))

    def delete_anchor(self, map: str, anchor: str, *, if_match: str | None = None) -> models.MapVersion:
        """Delete an anchor. Its detections stay with their keyframes, but no longer belong to an anchor."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, answer=models.MapVersion))

    def patch_anchor(self, map: str, anchor: str, body: models.AnchorPatchBody | Mapping[str, Any], *, if_match: str) -> models.Anchor:
        """Describe an anchor by hand. A manual description overrides later readings; null removes it. `if-
        match` states the version that the client has seen.
        """
        return self._call(Call("PATCH", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, body=body, answer=models.Anchor))

    def get_crop(self, map: str, anchor: str) -> bytes:
        """Read an anchor's best crop. The largest image of it in any detection, as it was sent."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/crop", answer=bytes))

    def get_transcript(self, map: str, anchor: str) -> models.TranscriptList:
        """Read how an anchor was described. The dialogues between a language model and a vision model
        about its crops, newest first; empty if no model has read one.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/transcript", answer=models.TranscriptList))

    def get_changes(self, map: str, *, since: str, until: str | None = None, limit: int | None = None) -> models.ReleaseChanges:
        """Compare a release with a later one. Keyframes, anchors and retired signs: what changed from
        `since` to `until`, or to the map as it stands. Tells whether robots need a newer release.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/changes", query={"since": since, "until": until, "limit": limit}, answer=models.ReleaseChanges))

    def erase(self, map: str, body: models.ErasureBody | Mapping[str, Any]) -> models.Erasure:
        """Erase keyframes or sessions for good. A job: it deletes the keyframes from the map and from each
        of its releases, revokes the loops that name them, empties the map's events and stored verdicts
        and the cache of models' answers, and then writes the database's file anew, so that no byte of
        them is left in it, in its log or in the next backup. While the file is written, writes to any
        map wait: seconds for each gigabyte. It needs as much free disk as the database has twice: in
        the log beside it, and in `SQLITE_TMPDIR` (else `/var/tmp`). Maps that began as copies are maps
        of their own. Poll the job until it is `done`; it survives restarts. Backups that were taken
        before still hold what was erased, and so does what other systems were sent.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/erase", body=body, answer=models.Erasure))

    def get_erasure(self, map: str, erasure: str) -> models.Erasure:
        """Read an erasure. Tells how far it is, and which backups still hold what it erased."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/erase/{segment(erasure)}", answer=models.Erasure))

    def get_frames(self, map: str, *, reference: str | None = None) -> models.Frames:
        """Put all sessions in one frame. Confirmed loops between sessions, verified by geometry, and
        alignments to plans say where the sessions lie to each other. Loops that contradict the rest do
        not count, and are listed as suspects (event `loop_suspected`). Computed after a loop was
        confirmed or revoked, and kept: the same version is the same to the byte. Loops without a
        transformation (the client sent none, and their query is not named, was not verified by
        geometry, or was no longer stored) are left out and counted. In a map that is not metric each
        session stands alone.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/frames", query={"reference": reference}, answer=models.Frames))

    def judge_again(self, map: str, body: models.JudgementBody | Mapping[str, Any]) -> models.Judgement:
        """Re-evaluate verdicts with a changed model. When a model or its prompts change, a map keeps its
        verdicts until this job re-evaluates them. With `'preview': true` it only returns the number of
        questions and their maximum cost. The job runs in the background within the budget and survives
        restarts; a map has one running job at a time. Replaced verdicts stay on record, and merged
        anchors stay merged.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/judgements", body=body, answer=models.Judgement))

    def get_judgement(self, map: str, id: str) -> models.Judgement:
        """Read a re-evaluation job. Returns its progress and the verdicts that it has replaced."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    def stop_judgement(self, map: str, id: str) -> models.Judgement:
        """Stop a re-evaluation job. Its results so far are kept. The job can still be read; a finished job
        does not change.
        """
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    def list_keyframes(self, map: str, *, redundant: bool | None = None, limit: int | None = None, cursor: str | None = None) -> models.KeyframeList:
        """List keyframes. In order of arrival, paged. With `redundant=true` only those that may be deleted
        when a quota nears: others see 90 % of their map points and every anchor. Each is so in its
        turn, without those before it in the page, so that all of a page may be deleted; delete them
        before the next page is asked for. A page looks at 1,000 keyframes at most, so it may be short
        or empty with a `next_cursor`. Nothing is deleted unasked.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes", query={"redundant": redundant, "limit": limit, "cursor": cursor}, answer=models.KeyframeList))

    def get_keyframe(self, map: str, keyframe: str) -> models.KeyframeView:
        """Read a keyframe. As it was sent, with its last corrected pose and points, with what it observes
        now, and the anchors of its detections.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.KeyframeView))

    def put_keyframe(self, map: str, keyframe: str, body: models.Keyframe | Mapping[str, Any], *, query: str | None = None, detail: str | None = None) -> models.KeyframeAnswer:
        """Store a keyframe. Its detections are associated with anchors. With `?query=loop` the response
        includes the answer of a loop query. Sending the same keyframe again changes nothing and returns
        200, also with its lists in another order or packed; a different one under the same id is a
        conflict.
        """
        return self._call(Call("PUT", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", query={"query": query, "detail": detail}, body=packed(body), answer=models.KeyframeAnswer))

    def delete_keyframe(self, map: str, keyframe: str) -> models.MapVersion:
        """Cull a keyframe. Deletes its observations, too, and any anchor without other observations."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.MapVersion))

    def list_covisible(self, map: str, keyframe: str) -> models.CovisibleList:
        """List covisible keyframes. Keyframes that share enough map points with it, or that a client or a
        confirmed loop declared covisible.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/covisible", answer=models.CovisibleList))

    def get_local_anchor_map(self, map: str, keyframe: str) -> models.LocalAnchorMap:
        """Read a local anchor map. M_k of §V-A: the anchors seen by a keyframe and its covisible
        keyframes, as bearings and distances from its camera.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/local-anchor-map", answer=models.LocalAnchorMap))

    def list_loop_queries(self, map: str, *, verdict: str | None = None, reason: str | None = None, session: str | None = None, since: int | None = None, until: int | None = None, release: str | None = None, limit: int | None = None, cursor: str | None = None) -> models.VerdictList:
        """List verdicts. The newest first, paged: a line for each loop query about a keyframe, the last
        100,000 of a map. Written behind: a crash may lose the last few. A question that is asked again,
        at the same version, has one line, with the time of the last. An erasure removes all lines of
        the map, for any of them may name what was erased.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/loop-queries", query={"verdict": verdict, "reason": reason, "session": session, "since": since, "until": until, "release": release, "limit": limit, "cursor": cursor}, answer=models.VerdictList))

    def query_loop(self, map: str, body: models.LoopQueryBody | Mapping[str, Any], *, detail: str | None = None) -> models.LoopAnswer:
        """Query whether a keyframe is a loop. The keyframe is a stored one, or one in the body. The query
        changes nothing and calls no model. The same map version, keyframe, settings and seed give the
        same bytes. A client that needs only the verdict asks for less with `?detail=brief`; the
        recorded verdict is whole all the same. A verdict does not close a loop. Once the client has
        closed the loop in its own map, it confirms that with `POST /v1/maps/{map}/loops`. From then on
        the two keyframes are covisible. The same query then returns the loop in `closed` and the reason
        `already_closed`.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/loop-queries", query={"detail": detail}, body=body, answer=models.LoopAnswer))

    def get_loop_query(self, map: str, query: str) -> models.LoopAnswer:
        """Read a verdict again. Returns the exact bytes of the answer. The number of records per map is
        limited; the oldest are deleted first.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/loop-queries/{segment(query)}", answer=models.LoopAnswer))

    def list_loops(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.LoopList:
        """List confirmed loops. Oldest first, paged."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/loops", query={"limit": limit, "cursor": cursor}, answer=models.LoopList))

    def confirm_loop(self, map: str, body: models.LoopBody | Mapping[str, Any]) -> models.LoopClosed:
        """Confirm a loop. States that the client has closed the loop. Matched anchors of the two local
        maps are merged, and the two keyframes become covisible. Only this closes a loop; the verdict of
        a query changes nothing. Evidence against the loop is returned in `warnings`.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/loops", body=body, answer=models.LoopClosed))

    def revoke_loop(self, map: str, loop: str) -> models.LoopRevoked:
        """Revoke a loop. For a loop that was wrong: its merges are undone, and the two keyframes are no
        longer covisible through it.
        """
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/loops/{segment(loop)}", answer=models.LoopRevoked))

    def bring_model_verdict(self, map: str, body: models.ModelVerdict | Mapping[str, Any]) -> models.ModelVerdictAnswer:
        """Import a model verdict. A level or a merged text of texts of one class, or the description of a
        detection's crop. It is applied like a verdict of this server's model, and calls none. A copy of
        a map, or a model that runs elsewhere, can import verdicts this way. It has no effect if no
        anchor has these texts, or if the crop's reading is final.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/model-verdicts", body=body, answer=models.ModelVerdictAnswer))

    def change_observations(self, map: str, body: models.ObservationsBody | Mapping[str, Any]) -> models.ObservationsAnswer:
        """Change what keyframes observe. For use when the robot's map has fused or culled map points, or
        found covisible keyframes, after the keyframes were sent. All of it is one transaction.
        Covisibility, the map points and boxes of anchors, and association follow as if the keyframes
        had been sent so, as far as `docs/method.md` (M57) says. Keyframes sent later name the points
        that stay. A retry of a keyframe is compared with its body as first sent. Repeating the request
        changes nothing.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/observations", body=body, answer=models.ObservationsAnswer))

    def correct_poses(self, map: str, body: models.PosesBody | Mapping[str, Any]) -> models.PosesAnswer:
        """Correct poses and map points. For use after the client has closed a loop and optimised its map.
        All corrections are one transaction. Boxes of anchors follow their points.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/poses", body=body, answer=models.PosesAnswer))

    def list_releases(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.ReleaseList:
        """List the releases of a map. Sorted by name, paged; each with the robots whose loop queries it
        answered.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/releases", query={"limit": limit, "cursor": cursor}, answer=models.ReleaseList))

    def get_release(self, map: str, release: str) -> models.Release:
        """Read a release. Includes the robots whose loop queries it answered."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/releases/{segment(release)}", answer=models.Release))

    def publish_release(self, map: str, release: str, body: models.ReleaseBody | Mapping[str, Any]) -> models.Release:
        """Publish a release of a map. The map as it stands, under a name: an immutable version that loop
        queries and `locate` may name, while robots go on writing to the map. It answers when all of it
        is on disk, which takes seconds for each gigabyte; writes to the map do not wait for it. A
        release takes as much disk as the map; a map has at most 64. Sending the same request again
        changes nothing and returns 200.
        """
        return self._call(Call("PUT", f"/v1/maps/{segment(map)}/releases/{segment(release)}", body=body, answer=models.Release))

    def delete_release(self, map: str, release: str) -> None:
        """Delete a release. Queries that name it answer 404 from then on. The map stays as it is."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/releases/{segment(release)}"))

    def list_sessions(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.SessionList:
        """List sessions. In order of appearance, paged. A session is aligned to a plan once two
        distinctive signs or more agree and no other place explains them as well; the alignment is
        computed anew as more signs are read.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/sessions", query={"limit": limit, "cursor": cursor}, answer=models.SessionList))

    def merge_sessions(self, map: str, session: str, body: models.MergeBody | Mapping[str, Any]) -> models.SessionsMergedAnswer:
        """Merge a session into another one. For use when two maps of a robot became one, as ORB-SLAM3's
        Atlas merges them. Keyframes keep their ids; they, their map points and anchors move into the
        frame of `into`, in one transaction. Covisibility and association follow (`docs/method.md`,
        M59). Keyframes sent later name `into`; one that names the session still begins it anew, in its
        own frame. Can be revoked until something is written in one of the two sessions.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/sessions/{segment(session)}/merge", body=body, answer=models.SessionsMergedAnswer))

    def revoke_merge(self, map: str, session: str) -> models.MergeRevokedAnswer:
        """Revoke a merge of sessions. For a merge that was wrong: everything is as before it, to the bit.
        Not possible once a keyframe, pose, map point or observation was written in one of the two
        sessions.
        """
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/sessions/{segment(session)}/merge", answer=models.MergeRevokedAnswer))

    def get_trajectory(self, map: str, *, format: str, session: str | None = None, frame: str | None = None, reference: str | None = None) -> str:
        """Read a trajectory. Poses (`map_from_camera`) as last corrected, by stamp. `tum`: lines of
        `seconds x y z qx qy qz qw`. `kitti`: lines of twelve numbers, the upper rows of the pose.
        `g2o`: a pose graph of all sessions, each in its own frame, with keyframes as vertices.
        `frame=fleet` puts all sessions that loops and plans join into one frame. Successive keyframes
        of a session are joined by their current relative pose. Confirmed loops are joined by the
        transformation of their `query`, with the inverse of its `covariance` as information. A loop
        whose query is no longer stored, or has no full transformation, is a comment. Information is in
        metres and radians, as gtsam and Ceres read it.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/trajectory", query={"format": format, "session": session, "frame": frame, "reference": reference}, answer=str))

    def information(self, body: models.OneText | Mapping[str, Any]) -> models.LevelAnswer:
        """InformationLevel of a description. From 1, no information, to 5, an identifier in context."""
        return self._call(Call("POST", "/v1/semantics/information", body=body, answer=models.LevelAnswer))

    def merge_text(self, body: models.TextPair | Mapping[str, Any]) -> models.MergeAnswer:
        """MergeText of two descriptions. Merges two descriptions of one object into one."""
        return self._call(Call("POST", "/v1/semantics/merge", body=body, answer=models.MergeAnswer))

    def similarity(self, body: models.TextPair | Mapping[str, Any]) -> models.LevelAnswer:
        """SimilarityLevel of two descriptions. From 1, different objects, to 5, the same object."""
        return self._call(Call("POST", "/v1/semantics/similarity", body=body, answer=models.LevelAnswer))

    def get_usage(self) -> models.Usage:
        """Read the usage of models. Calls, tokens and cost since the database was created, and today's
        usage against its limits.
        """
        return self._call(Call("GET", "/v1/usage", answer=models.Usage))

    def get_version(self) -> models.Version:
        """Read the server's version. Includes the version of the embedded SQLite."""
        return self._call(Call("GET", "/version", answer=models.Version))


class AsyncOperations:
    """Operations to be awaited."""

    async def _call(self, call: Call) -> Any:
        raise NotImplementedError

    async def healthz(self) -> models.Health:
        """Check liveness. Returns 200 while the process is alive."""
        return await self._call(Call("GET", "/healthz", answer=models.Health))

    async def get_metrics(self) -> str:
        """Read the metrics. In the OpenMetrics format, for Prometheus."""
        return await self._call(Call("GET", "/metrics", answer=str))

    async def get_document(self) -> dict[str, Any]:
        """Read this document. As JSON; `revisit openapi` prints it too."""
        return await self._call(Call("GET", "/openapi.json", answer=dict))

    async def readyz(self) -> models.Health:
        """Check readiness for requests. Returns 200 once the database is open, 503 after shutdown begins.
        Maps are loaded on first use. A server whose disk refuses writes still answers questions: it
        returns 200 with `degraded`, and why.
        """
        return await self._call(Call("GET", "/readyz", answer=models.Health))

    async def list_backups(self, *, limit: int | None = None, cursor: str | None = None) -> models.BackupList:
        """List backups. Newest first, paged."""
        return await self._call(Call("GET", "/v1/backups", query={"limit": limit, "cursor": cursor}, answer=models.BackupList))

    async def take_backup(self, body: models.BackupBody | Mapping[str, Any]) -> models.Backup:
        """Take a backup. Creates a complete copy of the database in the folder given by `revisit serve
        --backups`. It is verified and on disk when the response is sent. A verified backup is one that
        `revisit restore` accepts. If the database has faults, the copy is kept as `latest.damaged`, and
        the response is 500 (`backup_not_verified`) with the first faults. An existing id returns the
        existing backup. Only one backup runs at a time; another request receives 503. The oldest
        backups beyond the configured number are deleted.
        """
        return await self._call(Call("POST", "/v1/backups", body=body, answer=models.Backup))

    async def delete_backup(self, id: str) -> None:
        """Delete a backup. Its two files are removed from the folder given by `revisit serve --backups`."""
        return await self._call(Call("DELETE", f"/v1/backups/{segment(id)}"))

    async def list_keys(self, *, limit: int | None = None, cursor: str | None = None) -> models.KeyList:
        """List keys. In order of creation, including revoked ones. Secrets are not stored."""
        return await self._call(Call("GET", "/v1/keys", query={"limit": limit, "cursor": cursor}, answer=models.KeyList))

    async def create_key(self, body: models.KeyBody | Mapping[str, Any]) -> models.KeyView:
        """Create a key. The response contains the secret, which is shown only once. From the first key on,
        every request needs a key, including the viewer's. The first key must therefore be an
        administrator's: with `admin`, for every map, without an expiry (else 409). `revisit keys
        create` creates keys directly in the database, to regain access.
        """
        return await self._call(Call("POST", "/v1/keys", body=body, answer=models.KeyView))

    async def get_own_key(self) -> models.KeyView:
        """Read the key that asks. What it may do, and with which maps. A server that requires no key
        answers 404.
        """
        return await self._call(Call("GET", "/v1/keys/me", answer=models.KeyView))

    async def revoke_key(self, id: str, *, last_admin: bool | None = None) -> None:
        """Revoke a key. The key is rejected from now on and stays in the list. Revoking it again changes
        nothing. The last administrator key is revoked only with `last_admin=true` (else 409).
        """
        return await self._call(Call("DELETE", f"/v1/keys/{segment(id)}", query={"last_admin": last_admin}))

    async def locate(self, body: models.LocateBody | Mapping[str, Any]) -> models.LocateAnswer:
        """Find where a keyframe was taken. The keyframe need not have a pose: it is held against one,
        several or all maps that the key may query. The answer is `located` only where the confidence is
        at least 0.99. Where several places fit, it is `ambiguous`, and `look_for` names signs that
        would tell them apart; else it is `unknown`. The question stores nothing and calls no model. At
        most 64 maps are asked, and geometry looks at 20 pairs of keyframes at most.
        """
        return await self._call(Call("POST", "/v1/locate", body=body, answer=models.LocateAnswer))

    async def list_maps(self, *, limit: int | None = None, cursor: str | None = None) -> models.MapList:
        """List maps. Sorted by id, paged; only maps that the key covers."""
        return await self._call(Call("GET", "/v1/maps", query={"limit": limit, "cursor": cursor}, answer=models.MapList))

    async def get_map(self, map: str, *, detail: str | None = None) -> models.MapView:
        """Read a map. Includes every setting in force; with `?detail=brief` only those that differ from
        their defaults.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}", query={"detail": detail}, answer=models.MapView))

    async def put_map(self, map: str, body: models.MapBody | Mapping[str, Any], *, detail: str | None = None) -> models.MapView:
        """Create a map. Sending the same body again changes nothing and returns 200; a different body
        under the same id is a conflict. With a `base` the map begins as a copy of a release or of
        another map, and the answer comes when all of it is on disk; the key must have `read` for that.
        With `?detail=brief` the answer lists only the settings that differ from their defaults.
        """
        return await self._call(Call("PUT", f"/v1/maps/{segment(map)}", query={"detail": detail}, body=body, answer=models.MapView))

    async def delete_map(self, map: str) -> None:
        """Delete a map. Deletes everything in it."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}"))

    async def patch_map(self, map: str, body: models.MapPatchBody | Mapping[str, Any], *, detail: str | None = None) -> models.MapView:
        """Change a map. Omitted members keep their values; `settings` changes only the settings that it
        contains.
        """
        return await self._call(Call("PATCH", f"/v1/maps/{segment(map)}", query={"detail": detail}, body=body, answer=models.MapView))

    async def list_anchors(self, map: str, *, class_: str | None = None, text: str | None = None, state: str | None = None, merged: bool | None = None, prior: bool | None = None, limit: int | None = None, cursor: str | None = None) -> models.AnchorList:
        """Search anchors. Oldest first, paged. Merged anchors are omitted unless requested."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors", query={"class": class_, "text": text, "state": state, "merged": merged, "prior": prior, "limit": limit, "cursor": cursor}, answer=models.AnchorList))

    async def get_anchor(self, map: str, anchor: str) -> models.Anchor:
        """Read an anchor. Returns its readings, its position in each session's frame and the anchors that
        match it.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", answer=models.Anchor))

    async def put_prior_anchor(self, map: str, anchor: str, body: models.PriorBody | Mapping[str, Any]) -> models.Anchor:
        """Put a prior anchor. A sign that a floor plan shows, known before any robot has seen it. It
        matches what robots read, aligns their sessions to the plan, and closes no loop by itself. A
        plan's frame is a session that no robot drives.
        """
        return await self._call(Call("PUT", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", body=body, answer=models.Anchor))

    async def delete_anchor(self, map: str, anchor: str, *, if_match: str | None = None) -> models.MapVersion:
        """Delete an anchor. Its detections stay with their keyframes, but no longer belong to an anchor."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, answer=models.MapVersion))

    async def patch_anchor(self, map: str, anchor: str, body: models.AnchorPatchBody | Mapping[str, Any], *, if_match: str) -> models.Anchor:
        """Describe an anchor by hand. A manual description overrides later readings; null removes it. `if-
        match` states the version that the client has seen.
        """
        return await self._call(Call("PATCH", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, body=body, answer=models.Anchor))

    async def get_crop(self, map: str, anchor: str) -> bytes:
        """Read an anchor's best crop. The largest image of it in any detection, as it was sent."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/crop", answer=bytes))

    async def get_transcript(self, map: str, anchor: str) -> models.TranscriptList:
        """Read how an anchor was described. The dialogues between a language model and a vision model
        about its crops, newest first; empty if no model has read one.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/transcript", answer=models.TranscriptList))

    async def get_changes(self, map: str, *, since: str, until: str | None = None, limit: int | None = None) -> models.ReleaseChanges:
        """Compare a release with a later one. Keyframes, anchors and retired signs: what changed from
        `since` to `until`, or to the map as it stands. Tells whether robots need a newer release.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/changes", query={"since": since, "until": until, "limit": limit}, answer=models.ReleaseChanges))

    async def erase(self, map: str, body: models.ErasureBody | Mapping[str, Any]) -> models.Erasure:
        """Erase keyframes or sessions for good. A job: it deletes the keyframes from the map and from each
        of its releases, revokes the loops that name them, empties the map's events and stored verdicts
        and the cache of models' answers, and then writes the database's file anew, so that no byte of
        them is left in it, in its log or in the next backup. While the file is written, writes to any
        map wait: seconds for each gigabyte. It needs as much free disk as the database has twice: in
        the log beside it, and in `SQLITE_TMPDIR` (else `/var/tmp`). Maps that began as copies are maps
        of their own. Poll the job until it is `done`; it survives restarts. Backups that were taken
        before still hold what was erased, and so does what other systems were sent.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/erase", body=body, answer=models.Erasure))

    async def get_erasure(self, map: str, erasure: str) -> models.Erasure:
        """Read an erasure. Tells how far it is, and which backups still hold what it erased."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/erase/{segment(erasure)}", answer=models.Erasure))

    async def get_frames(self, map: str, *, reference: str | None = None) -> models.Frames:
        """Put all sessions in one frame. Confirmed loops between sessions, verified by geometry, and
        alignments to plans say where the sessions lie to each other. Loops that contradict the rest do
        not count, and are listed as suspects (event `loop_suspected`). Computed after a loop was
        confirmed or revoked, and kept: the same version is the same to the byte. Loops without a
        transformation (the client sent none, and their query is not named, was not verified by
        geometry, or was no longer stored) are left out and counted. In a map that is not metric each
        session stands alone.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/frames", query={"reference": reference}, answer=models.Frames))

    async def judge_again(self, map: str, body: models.JudgementBody | Mapping[str, Any]) -> models.Judgement:
        """Re-evaluate verdicts with a changed model. When a model or its prompts change, a map keeps its
        verdicts until this job re-evaluates them. With `'preview': true` it only returns the number of
        questions and their maximum cost. The job runs in the background within the budget and survives
        restarts; a map has one running job at a time. Replaced verdicts stay on record, and merged
        anchors stay merged.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/judgements", body=body, answer=models.Judgement))

    async def get_judgement(self, map: str, id: str) -> models.Judgement:
        """Read a re-evaluation job. Returns its progress and the verdicts that it has replaced."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    async def stop_judgement(self, map: str, id: str) -> models.Judgement:
        """Stop a re-evaluation job. Its results so far are kept. The job can still be read; a finished job
        does not change.
        """
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    async def list_keyframes(self, map: str, *, redundant: bool | None = None, limit: int | None = None, cursor: str | None = None) -> models.KeyframeList:
        """List keyframes. In order of arrival, paged. With `redundant=true` only those that may be deleted
        when a quota nears: others see 90 % of their map points and every anchor. Each is so in its
        turn, without those before it in the page, so that all of a page may be deleted; delete them
        before the next page is asked for. A page looks at 1,000 keyframes at most, so it may be short
        or empty with a `next_cursor`. Nothing is deleted unasked.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes", query={"redundant": redundant, "limit": limit, "cursor": cursor}, answer=models.KeyframeList))

    async def get_keyframe(self, map: str, keyframe: str) -> models.KeyframeView:
        """Read a keyframe. As it was sent, with its last corrected pose and points, with what it observes
        now, and the anchors of its detections.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.KeyframeView))

    async def put_keyframe(self, map: str, keyframe: str, body: models.Keyframe | Mapping[str, Any], *, query: str | None = None, detail: str | None = None) -> models.KeyframeAnswer:
        """Store a keyframe. Its detections are associated with anchors. With `?query=loop` the response
        includes the answer of a loop query. Sending the same keyframe again changes nothing and returns
        200, also with its lists in another order or packed; a different one under the same id is a
        conflict.
        """
        return await self._call(Call("PUT", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", query={"query": query, "detail": detail}, body=packed(body), answer=models.KeyframeAnswer))

    async def delete_keyframe(self, map: str, keyframe: str) -> models.MapVersion:
        """Cull a keyframe. Deletes its observations, too, and any anchor without other observations."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.MapVersion))

    async def list_covisible(self, map: str, keyframe: str) -> models.CovisibleList:
        """List covisible keyframes. Keyframes that share enough map points with it, or that a client or a
        confirmed loop declared covisible.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/covisible", answer=models.CovisibleList))

    async def get_local_anchor_map(self, map: str, keyframe: str) -> models.LocalAnchorMap:
        """Read a local anchor map. M_k of §V-A: the anchors seen by a keyframe and its covisible
        keyframes, as bearings and distances from its camera.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/local-anchor-map", answer=models.LocalAnchorMap))

    async def list_loop_queries(self, map: str, *, verdict: str | None = None, reason: str | None = None, session: str | None = None, since: int | None = None, until: int | None = None, release: str | None = None, limit: int | None = None, cursor: str | None = None) -> models.VerdictList:
        """List verdicts. The newest first, paged: a line for each loop query about a keyframe, the last
        100,000 of a map. Written behind: a crash may lose the last few. A question that is asked again,
        at the same version, has one line, with the time of the last. An erasure removes all lines of
        the map, for any of them may name what was erased.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/loop-queries", query={"verdict": verdict, "reason": reason, "session": session, "since": since, "until": until, "release": release, "limit": limit, "cursor": cursor}, answer=models.VerdictList))

    async def query_loop(self, map: str, body: models.LoopQueryBody | Mapping[str, Any], *, detail: str | None = None) -> models.LoopAnswer:
        """Query whether a keyframe is a loop. The keyframe is a stored one, or one in the body. The query
        changes nothing and calls no model. The same map version, keyframe, settings and seed give the
        same bytes. A client that needs only the verdict asks for less with `?detail=brief`; the
        recorded verdict is whole all the same. A verdict does not close a loop. Once the client has
        closed the loop in its own map, it confirms that with `POST /v1/maps/{map}/loops`. From then on
        the two keyframes are covisible. The same query then returns the loop in `closed` and the reason
        `already_closed`.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/loop-queries", query={"detail": detail}, body=body, answer=models.LoopAnswer))

    async def get_loop_query(self, map: str, query: str) -> models.LoopAnswer:
        """Read a verdict again. Returns the exact bytes of the answer. The number of records per map is
        limited; the oldest are deleted first.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/loop-queries/{segment(query)}", answer=models.LoopAnswer))

    async def list_loops(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.LoopList:
        """List confirmed loops. Oldest first, paged."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/loops", query={"limit": limit, "cursor": cursor}, answer=models.LoopList))

    async def confirm_loop(self, map: str, body: models.LoopBody | Mapping[str, Any]) -> models.LoopClosed:
        """Confirm a loop. States that the client has closed the loop. Matched anchors of the two local
        maps are merged, and the two keyframes become covisible. Only this closes a loop; the verdict of
        a query changes nothing. Evidence against the loop is returned in `warnings`.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/loops", body=body, answer=models.LoopClosed))

    async def revoke_loop(self, map: str, loop: str) -> models.LoopRevoked:
        """Revoke a loop. For a loop that was wrong: its merges are undone, and the two keyframes are no
        longer covisible through it.
        """
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/loops/{segment(loop)}", answer=models.LoopRevoked))

    async def bring_model_verdict(self, map: str, body: models.ModelVerdict | Mapping[str, Any]) -> models.ModelVerdictAnswer:
        """Import a model verdict. A level or a merged text of texts of one class, or the description of a
        detection's crop. It is applied like a verdict of this server's model, and calls none. A copy of
        a map, or a model that runs elsewhere, can import verdicts this way. It has no effect if no
        anchor has these texts, or if the crop's reading is final.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/model-verdicts", body=body, answer=models.ModelVerdictAnswer))

    async def change_observations(self, map: str, body: models.ObservationsBody | Mapping[str, Any]) -> models.ObservationsAnswer:
        """Change what keyframes observe. For use when the robot's map has fused or culled map points, or
        found covisible keyframes, after the keyframes were sent. All of it is one transaction.
        Covisibility, the map points and boxes of anchors, and association follow as if the keyframes
        had been sent so, as far as `docs/method.md` (M57) says. Keyframes sent later name the points
        that stay. A retry of a keyframe is compared with its body as first sent. Repeating the request
        changes nothing.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/observations", body=body, answer=models.ObservationsAnswer))

    async def correct_poses(self, map: str, body: models.PosesBody | Mapping[str, Any]) -> models.PosesAnswer:
        """Correct poses and map points. For use after the client has closed a loop and optimised its map.
        All corrections are one transaction. Boxes of anchors follow their points.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/poses", body=body, answer=models.PosesAnswer))

    async def list_releases(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.ReleaseList:
        """List the releases of a map. Sorted by name, paged; each with the robots whose loop queries it
        answered.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/releases", query={"limit": limit, "cursor": cursor}, answer=models.ReleaseList))

    async def get_release(self, map: str, release: str) -> models.Release:
        """Read a release. Includes the robots whose loop queries it answered."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/releases/{segment(release)}", answer=models.Release))

    async def publish_release(self, map: str, release: str, body: models.ReleaseBody | Mapping[str, Any]) -> models.Release:
        """Publish a release of a map. The map as it stands, under a name: an immutable version that loop
        queries and `locate` may name, while robots go on writing to the map. It answers when all of it
        is on disk, which takes seconds for each gigabyte; writes to the map do not wait for it. A
        release takes as much disk as the map; a map has at most 64. Sending the same request again
        changes nothing and returns 200.
        """
        return await self._call(Call("PUT", f"/v1/maps/{segment(map)}/releases/{segment(release)}", body=body, answer=models.Release))

    async def delete_release(self, map: str, release: str) -> None:
        """Delete a release. Queries that name it answer 404 from then on. The map stays as it is."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/releases/{segment(release)}"))

    async def list_sessions(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.SessionList:
        """List sessions. In order of appearance, paged. A session is aligned to a plan once two
        distinctive signs or more agree and no other place explains them as well; the alignment is
        computed anew as more signs are read.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/sessions", query={"limit": limit, "cursor": cursor}, answer=models.SessionList))

    async def merge_sessions(self, map: str, session: str, body: models.MergeBody | Mapping[str, Any]) -> models.SessionsMergedAnswer:
        """Merge a session into another one. For use when two maps of a robot became one, as ORB-SLAM3's
        Atlas merges them. Keyframes keep their ids; they, their map points and anchors move into the
        frame of `into`, in one transaction. Covisibility and association follow (`docs/method.md`,
        M59). Keyframes sent later name `into`; one that names the session still begins it anew, in its
        own frame. Can be revoked until something is written in one of the two sessions.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/sessions/{segment(session)}/merge", body=body, answer=models.SessionsMergedAnswer))

    async def revoke_merge(self, map: str, session: str) -> models.MergeRevokedAnswer:
        """Revoke a merge of sessions. For a merge that was wrong: everything is as before it, to the bit.
        Not possible once a keyframe, pose, map point or observation was written in one of the two
        sessions.
        """
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/sessions/{segment(session)}/merge", answer=models.MergeRevokedAnswer))

    async def get_trajectory(self, map: str, *, format: str, session: str | None = None, frame: str | None = None, reference: str | None = None) -> str:
        """Read a trajectory. Poses (`map_from_camera`) as last corrected, by stamp. `tum`: lines of
        `seconds x y z qx qy qz qw`. `kitti`: lines of twelve numbers, the upper rows of the pose.
        `g2o`: a pose graph of all sessions, each in its own frame, with keyframes as vertices.
        `frame=fleet` puts all sessions that loops and plans join into one frame. Successive keyframes
        of a session are joined by their current relative pose. Confirmed loops are joined by the
        transformation of their `query`, with the inverse of its `covariance` as information. A loop
        whose query is no longer stored, or has no full transformation, is a comment. Information is in
        metres and radians, as gtsam and Ceres read it.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/trajectory", query={"format": format, "session": session, "frame": frame, "reference": reference}, answer=str))

    async def information(self, body: models.OneText | Mapping[str, Any]) -> models.LevelAnswer:
        """InformationLevel of a description. From 1, no information, to 5, an identifier in context."""
        return await self._call(Call("POST", "/v1/semantics/information", body=body, answer=models.LevelAnswer))

    async def merge_text(self, body: models.TextPair | Mapping[str, Any]) -> models.MergeAnswer:
        """MergeText of two descriptions. Merges two descriptions of one object into one."""
        return await self._call(Call("POST", "/v1/semantics/merge", body=body, answer=models.MergeAnswer))

    async def similarity(self, body: models.TextPair | Mapping[str, Any]) -> models.LevelAnswer:
        """SimilarityLevel of two descriptions. From 1, different objects, to 5, the same object."""
        return await self._call(Call("POST", "/v1/semantics/similarity", body=body, answer=models.LevelAnswer))

    async def get_usage(self) -> models.Usage:
        """Read the usage of models. Calls, tokens and cost since the database was created, and today's
        usage against its limits.
        """
        return await self._call(Call("GET", "/v1/usage", answer=models.Usage))

    async def get_version(self) -> models.Version:
        """Read the server's version. Includes the version of the embedded SQLite."""
        return await self._call(Call("GET", "/version", answer=models.Version))
