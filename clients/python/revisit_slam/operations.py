"""One method an operation. Made from the API document by tools/generate.py: do not edit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import models
from .call import Call, segment


class Operations:
    """Operations that block until they are answered."""

    def _call(self, call: Call) -> Any:
        raise NotImplementedError

    def healthz(self) -> models.Health:
        """Is the process alive? It answers, so it is."""
        return self._call(Call("GET", "/healthz", answer=models.Health))

    def get_metrics(self) -> str:
        """Read the metrics. In the form of OpenMetrics, for Prometheus."""
        return self._call(Call("GET", "/metrics", answer=str))

    def get_document(self) -> dict[str, Any]:
        """Read this document. As JSON; `revisit openapi` prints it too."""
        return self._call(Call("GET", "/openapi.json", answer=dict))

    def readyz(self) -> models.Health:
        """Is the server ready for requests? 200 once the database is open, 503 from the moment the server
        is told to stop. Maps are loaded when they are first asked for.
        """
        return self._call(Call("GET", "/readyz", answer=models.Health))

    def list_backups(self, *, limit: int | None = None, cursor: str | None = None) -> models.BackupList:
        """List backups. The newest first, one part at a time."""
        return self._call(Call("GET", "/v1/backups", query={"limit": limit, "cursor": cursor}, answer=models.BackupList))

    def take_backup(self, body: models.BackupBody | Mapping[str, Any]) -> models.Backup:
        """Take a backup. A whole copy of the database as it is now, into the folder that `revisit serve
        --backups` names; verified and on disk when it is answered. Verified is what `revisit restore`
        would accept; a copy of a database with faults is kept apart, as `latest.damaged`, and answered
        500 (`backup_not_verified`) with the first faults. The same id again is answered with the backup
        that is there. One at a time: another one meanwhile is told to wait. The oldest beyond the
        number that is kept make room.
        """
        return self._call(Call("POST", "/v1/backups", body=body, answer=models.Backup))

    def list_keys(self, *, limit: int | None = None, cursor: str | None = None) -> models.KeyList:
        """List keys. In order of creation, revoked ones among them; secrets are kept nowhere."""
        return self._call(Call("GET", "/v1/keys", query={"limit": limit, "cursor": cursor}, answer=models.KeyList))

    def create_key(self, body: models.KeyBody | Mapping[str, Any]) -> models.KeyView:
        """Make a key. The answer shows its secret, once. From the first key on, every request needs a key,
        the viewer's too. So a server's first key must be able to administer: with `admin`, for every
        map, without an expiry (else 409). `revisit keys create` makes keys in the database itself, and
        is the way back in.
        """
        return self._call(Call("POST", "/v1/keys", body=body, answer=models.KeyView))

    def revoke_key(self, id: str, *, last_admin: bool | None = None) -> None:
        """Revoke a key. It is refused from now on, and stays in the list. Revoking it again changes
        nothing. The last key that may administer is revoked only with `last_admin=true` (else 409).
        """
        return self._call(Call("DELETE", f"/v1/keys/{segment(id)}", query={"last_admin": last_admin}))

    def list_maps(self, *, limit: int | None = None, cursor: str | None = None) -> models.MapList:
        """List maps. By id, one part at a time; those that exist for the key."""
        return self._call(Call("GET", "/v1/maps", query={"limit": limit, "cursor": cursor}, answer=models.MapList))

    def get_map(self, map: str) -> models.MapView:
        """Read a map. With every setting in force."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}", answer=models.MapView))

    def put_map(self, map: str, body: models.MapBody | Mapping[str, Any]) -> models.MapView:
        """Make a map. The same body again changes nothing and answers 200; another body under the same id
        is a conflict.
        """
        return self._call(Call("PUT", f"/v1/maps/{segment(map)}", body=body, answer=models.MapView))

    def delete_map(self, map: str) -> None:
        """Delete a map. With everything in it."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}"))

    def patch_map(self, map: str, body: models.MapPatchBody | Mapping[str, Any]) -> models.MapView:
        """Change a map. What is left out stays as it is; `settings` changes the settings it names."""
        return self._call(Call("PATCH", f"/v1/maps/{segment(map)}", body=body, answer=models.MapView))

    def list_anchors(self, map: str, *, class_: str | None = None, text: str | None = None, state: str | None = None, merged: bool | None = None, limit: int | None = None, cursor: str | None = None) -> models.AnchorList:
        """Search anchors. Oldest first, one part at a time. Anchors that go by another one's name are left
        out unless asked for.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors", query={"class": class_, "text": text, "state": state, "merged": merged, "limit": limit, "cursor": cursor}, answer=models.AnchorList))

    def get_anchor(self, map: str, anchor: str) -> models.Anchor:
        """Read an anchor. With its readings, its place in each session's frame and the anchors that match
        it.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", answer=models.Anchor))

    def delete_anchor(self, map: str, anchor: str, *, if_match: str | None = None) -> models.MapVersion:
        """Delete an anchor. Its detections stay with their keyframes and feed nothing any more."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, answer=models.MapVersion))

    def patch_anchor(self, map: str, anchor: str, body: models.AnchorPatchBody | Mapping[str, Any], *, if_match: str) -> models.Anchor:
        """Describe an anchor by hand. The description stands whatever is read later; null takes it back.
        `if-match` says which version was seen.
        """
        return self._call(Call("PATCH", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, body=body, answer=models.Anchor))

    def get_crop(self, map: str, anchor: str) -> bytes:
        """Read an anchor's best crop. The largest image of it that a detection brought, as it was sent."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/crop", answer=bytes))

    def get_transcript(self, map: str, anchor: str) -> models.TranscriptList:
        """Read how an anchor was described. The dialogues between a language model and a vision model
        about its crops, the newest first; none where no model has read one.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/transcript", answer=models.TranscriptList))

    def judge_again(self, map: str, body: models.JudgementBody | Mapping[str, Any]) -> models.Judgement:
        """Ask a changed model again. When a model or its prompts change, the verdicts of a map stay as
        they are until this job asks for them again. With `'preview': true` it only counts the questions
        and what they may cost. The job goes on in the background, within the budget and over restarts;
        one job of a map runs at a time. Verdicts that it replaces stay on record, and anchors that were
        merged stay merged.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/judgements", body=body, answer=models.Judgement))

    def get_judgement(self, map: str, id: str) -> models.Judgement:
        """Read a job that asks again. How far it is, and which verdicts it has replaced by others."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    def stop_judgement(self, map: str, id: str) -> models.Judgement:
        """Stop a job that asks again. What it has learned stays. The job can still be read; one that has
        ended stays as it is.
        """
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    def list_keyframes(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.KeyframeList:
        """List keyframes. In order of arrival, one part at a time."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes", query={"limit": limit, "cursor": cursor}, answer=models.KeyframeList))

    def get_keyframe(self, map: str, keyframe: str) -> models.KeyframeView:
        """Read a keyframe. As it was sent, with its pose and its points as last corrected, and what became
        of its detections.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.KeyframeView))

    def put_keyframe(self, map: str, keyframe: str, body: models.Keyframe | Mapping[str, Any], *, query: str | None = None) -> models.KeyframeAnswer:
        """Store a keyframe. Its detections are associated with anchors; with `?query=loop` the loop query
        is answered in the same round trip. The same body again changes nothing and answers 200; another
        body under the same id is a conflict.
        """
        return self._call(Call("PUT", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", query={"query": query}, body=body, answer=models.KeyframeAnswer))

    def delete_keyframe(self, map: str, keyframe: str) -> models.MapVersion:
        """Cull a keyframe. Its observations go with it; an anchor that loses its last one goes too."""
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.MapVersion))

    def list_covisible(self, map: str, keyframe: str) -> models.CovisibleList:
        """List covisible keyframes. Those that share enough map points with it, and those declared
        covisible, by a client or by a confirmed loop.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/covisible", answer=models.CovisibleList))

    def get_local_anchor_map(self, map: str, keyframe: str) -> models.LocalAnchorMap:
        """Read a local anchor map. M_k of §V-A: the anchors seen by a keyframe and those covisible with
        it, as bearings and distances from its camera.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/local-anchor-map", answer=models.LocalAnchorMap))

    def query_loop(self, map: str, body: models.LoopQueryBody | Mapping[str, Any]) -> models.LoopAnswer:
        """Ask whether a keyframe is a loop. About a stored keyframe or one sent along. It changes nothing
        and calls no model; the same map version, keyframe, settings and seed give the same bytes. A
        verdict is not yet a closed loop: it is an answer. Once the client has closed the loop in its
        own map, it confirms that with `POST /v1/maps/{map}/loops`. From then on the two keyframes are
        covisible, and the same question is answered with the loop in `closed` and the reason
        `already_closed`.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/loop-queries", body=body, answer=models.LoopAnswer))

    def get_loop_query(self, map: str, query: str) -> models.LoopAnswer:
        """Read a verdict again. The very bytes that were answered. Records are bounded for each map, the
        oldest go first.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/loop-queries/{segment(query)}", answer=models.LoopAnswer))

    def list_loops(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.LoopList:
        """List confirmed loops. Oldest first, one part at a time."""
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/loops", query={"limit": limit, "cursor": cursor}, answer=models.LoopList))

    def confirm_loop(self, map: str, body: models.LoopBody | Mapping[str, Any]) -> models.LoopClosed:
        """Confirm a loop. The client has closed it: anchors matched between the two local maps become one,
        and the two keyframes covisible. Only this closes a loop; a verdict of a query changes nothing.
        What speaks against it is told in `warnings`.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/loops", body=body, answer=models.LoopClosed))

    def revoke_loop(self, map: str, loop: str) -> models.LoopRevoked:
        """Revoke a loop. It was none after all: what it merged is split again, and the two keyframes are
        no longer covisible through it.
        """
        return self._call(Call("DELETE", f"/v1/maps/{segment(map)}/loops/{segment(loop)}", answer=models.LoopRevoked))

    def bring_model_verdict(self, map: str, body: models.ModelVerdict | Mapping[str, Any]) -> models.ModelVerdictAnswer:
        """Bring what a model said. A level or a merged text of texts of one class, or the description of a
        detection's crop: it is applied as if a model of this server had said it, and asks none. So a
        copy of a map, or a model that runs elsewhere, brings its verdicts. Where no anchor carries the
        texts, or the crop was read for good, it changes nothing.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/model-verdicts", body=body, answer=models.ModelVerdictAnswer))

    def correct_poses(self, map: str, body: models.PosesBody | Mapping[str, Any]) -> models.PosesAnswer:
        """Correct poses and map points. After a loop was closed and the client has optimised: all of it in
        one transaction, or nothing. Boxes of anchors follow their points.
        """
        return self._call(Call("POST", f"/v1/maps/{segment(map)}/poses", body=body, answer=models.PosesAnswer))

    def get_trajectory(self, map: str, *, format: str, session: str | None = None) -> str:
        """Read a trajectory. Poses (`map_from_camera`) as last corrected, by stamp. `tum`: lines of
        `seconds x y z qx qy qz qw`. `kitti`: lines of twelve numbers, the upper rows of the pose.
        `g2o`: a pose graph of all sessions, each in its own frame: keyframes are vertices, neighbours
        of a session are joined as far apart as they are now, and confirmed loops by the transformation
        of their `query`, with the information that its `covariance` leaves. A loop whose query is not
        kept, or verified no full transformation, is a comment. Information is in metres and radians, as
        gtsam and Ceres read it.
        """
        return self._call(Call("GET", f"/v1/maps/{segment(map)}/trajectory", query={"format": format, "session": session}, answer=str))

    def information(self, body: models.OneText | Mapping[str, Any]) -> models.LevelAnswer:
        """InformationLevel of a description. 1 says nothing, 5 an identifier in context."""
        return self._call(Call("POST", "/v1/semantics/information", body=body, answer=models.LevelAnswer))

    def merge_text(self, body: models.TextPair | Mapping[str, Any]) -> models.MergeAnswer:
        """MergeText of two descriptions. One description of what both describe."""
        return self._call(Call("POST", "/v1/semantics/merge", body=body, answer=models.MergeAnswer))

    def similarity(self, body: models.TextPair | Mapping[str, Any]) -> models.LevelAnswer:
        """SimilarityLevel of two descriptions. 1 different objects, 5 the same."""
        return self._call(Call("POST", "/v1/semantics/similarity", body=body, answer=models.LevelAnswer))

    def get_usage(self) -> models.Usage:
        """Read the usage of models. Calls, tokens and cost since the database was made, and how today
        stands against its limits.
        """
        return self._call(Call("GET", "/v1/usage", answer=models.Usage))

    def get_version(self) -> models.Version:
        """Read the server's version. With that of the SQLite inside it."""
        return self._call(Call("GET", "/version", answer=models.Version))


class AsyncOperations:
    """Operations to be awaited."""

    async def _call(self, call: Call) -> Any:
        raise NotImplementedError

    async def healthz(self) -> models.Health:
        """Is the process alive? It answers, so it is."""
        return await self._call(Call("GET", "/healthz", answer=models.Health))

    async def get_metrics(self) -> str:
        """Read the metrics. In the form of OpenMetrics, for Prometheus."""
        return await self._call(Call("GET", "/metrics", answer=str))

    async def get_document(self) -> dict[str, Any]:
        """Read this document. As JSON; `revisit openapi` prints it too."""
        return await self._call(Call("GET", "/openapi.json", answer=dict))

    async def readyz(self) -> models.Health:
        """Is the server ready for requests? 200 once the database is open, 503 from the moment the server
        is told to stop. Maps are loaded when they are first asked for.
        """
        return await self._call(Call("GET", "/readyz", answer=models.Health))

    async def list_backups(self, *, limit: int | None = None, cursor: str | None = None) -> models.BackupList:
        """List backups. The newest first, one part at a time."""
        return await self._call(Call("GET", "/v1/backups", query={"limit": limit, "cursor": cursor}, answer=models.BackupList))

    async def take_backup(self, body: models.BackupBody | Mapping[str, Any]) -> models.Backup:
        """Take a backup. A whole copy of the database as it is now, into the folder that `revisit serve
        --backups` names; verified and on disk when it is answered. Verified is what `revisit restore`
        would accept; a copy of a database with faults is kept apart, as `latest.damaged`, and answered
        500 (`backup_not_verified`) with the first faults. The same id again is answered with the backup
        that is there. One at a time: another one meanwhile is told to wait. The oldest beyond the
        number that is kept make room.
        """
        return await self._call(Call("POST", "/v1/backups", body=body, answer=models.Backup))

    async def list_keys(self, *, limit: int | None = None, cursor: str | None = None) -> models.KeyList:
        """List keys. In order of creation, revoked ones among them; secrets are kept nowhere."""
        return await self._call(Call("GET", "/v1/keys", query={"limit": limit, "cursor": cursor}, answer=models.KeyList))

    async def create_key(self, body: models.KeyBody | Mapping[str, Any]) -> models.KeyView:
        """Make a key. The answer shows its secret, once. From the first key on, every request needs a key,
        the viewer's too. So a server's first key must be able to administer: with `admin`, for every
        map, without an expiry (else 409). `revisit keys create` makes keys in the database itself, and
        is the way back in.
        """
        return await self._call(Call("POST", "/v1/keys", body=body, answer=models.KeyView))

    async def revoke_key(self, id: str, *, last_admin: bool | None = None) -> None:
        """Revoke a key. It is refused from now on, and stays in the list. Revoking it again changes
        nothing. The last key that may administer is revoked only with `last_admin=true` (else 409).
        """
        return await self._call(Call("DELETE", f"/v1/keys/{segment(id)}", query={"last_admin": last_admin}))

    async def list_maps(self, *, limit: int | None = None, cursor: str | None = None) -> models.MapList:
        """List maps. By id, one part at a time; those that exist for the key."""
        return await self._call(Call("GET", "/v1/maps", query={"limit": limit, "cursor": cursor}, answer=models.MapList))

    async def get_map(self, map: str) -> models.MapView:
        """Read a map. With every setting in force."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}", answer=models.MapView))

    async def put_map(self, map: str, body: models.MapBody | Mapping[str, Any]) -> models.MapView:
        """Make a map. The same body again changes nothing and answers 200; another body under the same id
        is a conflict.
        """
        return await self._call(Call("PUT", f"/v1/maps/{segment(map)}", body=body, answer=models.MapView))

    async def delete_map(self, map: str) -> None:
        """Delete a map. With everything in it."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}"))

    async def patch_map(self, map: str, body: models.MapPatchBody | Mapping[str, Any]) -> models.MapView:
        """Change a map. What is left out stays as it is; `settings` changes the settings it names."""
        return await self._call(Call("PATCH", f"/v1/maps/{segment(map)}", body=body, answer=models.MapView))

    async def list_anchors(self, map: str, *, class_: str | None = None, text: str | None = None, state: str | None = None, merged: bool | None = None, limit: int | None = None, cursor: str | None = None) -> models.AnchorList:
        """Search anchors. Oldest first, one part at a time. Anchors that go by another one's name are left
        out unless asked for.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors", query={"class": class_, "text": text, "state": state, "merged": merged, "limit": limit, "cursor": cursor}, answer=models.AnchorList))

    async def get_anchor(self, map: str, anchor: str) -> models.Anchor:
        """Read an anchor. With its readings, its place in each session's frame and the anchors that match
        it.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", answer=models.Anchor))

    async def delete_anchor(self, map: str, anchor: str, *, if_match: str | None = None) -> models.MapVersion:
        """Delete an anchor. Its detections stay with their keyframes and feed nothing any more."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, answer=models.MapVersion))

    async def patch_anchor(self, map: str, anchor: str, body: models.AnchorPatchBody | Mapping[str, Any], *, if_match: str) -> models.Anchor:
        """Describe an anchor by hand. The description stands whatever is read later; null takes it back.
        `if-match` says which version was seen.
        """
        return await self._call(Call("PATCH", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}", headers={"if-match": if_match}, body=body, answer=models.Anchor))

    async def get_crop(self, map: str, anchor: str) -> bytes:
        """Read an anchor's best crop. The largest image of it that a detection brought, as it was sent."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/crop", answer=bytes))

    async def get_transcript(self, map: str, anchor: str) -> models.TranscriptList:
        """Read how an anchor was described. The dialogues between a language model and a vision model
        about its crops, the newest first; none where no model has read one.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/anchors/{segment(anchor)}/transcript", answer=models.TranscriptList))

    async def judge_again(self, map: str, body: models.JudgementBody | Mapping[str, Any]) -> models.Judgement:
        """Ask a changed model again. When a model or its prompts change, the verdicts of a map stay as
        they are until this job asks for them again. With `'preview': true` it only counts the questions
        and what they may cost. The job goes on in the background, within the budget and over restarts;
        one job of a map runs at a time. Verdicts that it replaces stay on record, and anchors that were
        merged stay merged.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/judgements", body=body, answer=models.Judgement))

    async def get_judgement(self, map: str, id: str) -> models.Judgement:
        """Read a job that asks again. How far it is, and which verdicts it has replaced by others."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    async def stop_judgement(self, map: str, id: str) -> models.Judgement:
        """Stop a job that asks again. What it has learned stays. The job can still be read; one that has
        ended stays as it is.
        """
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/judgements/{segment(id)}", answer=models.Judgement))

    async def list_keyframes(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.KeyframeList:
        """List keyframes. In order of arrival, one part at a time."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes", query={"limit": limit, "cursor": cursor}, answer=models.KeyframeList))

    async def get_keyframe(self, map: str, keyframe: str) -> models.KeyframeView:
        """Read a keyframe. As it was sent, with its pose and its points as last corrected, and what became
        of its detections.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.KeyframeView))

    async def put_keyframe(self, map: str, keyframe: str, body: models.Keyframe | Mapping[str, Any], *, query: str | None = None) -> models.KeyframeAnswer:
        """Store a keyframe. Its detections are associated with anchors; with `?query=loop` the loop query
        is answered in the same round trip. The same body again changes nothing and answers 200; another
        body under the same id is a conflict.
        """
        return await self._call(Call("PUT", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", query={"query": query}, body=body, answer=models.KeyframeAnswer))

    async def delete_keyframe(self, map: str, keyframe: str) -> models.MapVersion:
        """Cull a keyframe. Its observations go with it; an anchor that loses its last one goes too."""
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}", answer=models.MapVersion))

    async def list_covisible(self, map: str, keyframe: str) -> models.CovisibleList:
        """List covisible keyframes. Those that share enough map points with it, and those declared
        covisible, by a client or by a confirmed loop.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/covisible", answer=models.CovisibleList))

    async def get_local_anchor_map(self, map: str, keyframe: str) -> models.LocalAnchorMap:
        """Read a local anchor map. M_k of §V-A: the anchors seen by a keyframe and those covisible with
        it, as bearings and distances from its camera.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/keyframes/{segment(keyframe)}/local-anchor-map", answer=models.LocalAnchorMap))

    async def query_loop(self, map: str, body: models.LoopQueryBody | Mapping[str, Any]) -> models.LoopAnswer:
        """Ask whether a keyframe is a loop. About a stored keyframe or one sent along. It changes nothing
        and calls no model; the same map version, keyframe, settings and seed give the same bytes. A
        verdict is not yet a closed loop: it is an answer. Once the client has closed the loop in its
        own map, it confirms that with `POST /v1/maps/{map}/loops`. From then on the two keyframes are
        covisible, and the same question is answered with the loop in `closed` and the reason
        `already_closed`.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/loop-queries", body=body, answer=models.LoopAnswer))

    async def get_loop_query(self, map: str, query: str) -> models.LoopAnswer:
        """Read a verdict again. The very bytes that were answered. Records are bounded for each map, the
        oldest go first.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/loop-queries/{segment(query)}", answer=models.LoopAnswer))

    async def list_loops(self, map: str, *, limit: int | None = None, cursor: str | None = None) -> models.LoopList:
        """List confirmed loops. Oldest first, one part at a time."""
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/loops", query={"limit": limit, "cursor": cursor}, answer=models.LoopList))

    async def confirm_loop(self, map: str, body: models.LoopBody | Mapping[str, Any]) -> models.LoopClosed:
        """Confirm a loop. The client has closed it: anchors matched between the two local maps become one,
        and the two keyframes covisible. Only this closes a loop; a verdict of a query changes nothing.
        What speaks against it is told in `warnings`.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/loops", body=body, answer=models.LoopClosed))

    async def revoke_loop(self, map: str, loop: str) -> models.LoopRevoked:
        """Revoke a loop. It was none after all: what it merged is split again, and the two keyframes are
        no longer covisible through it.
        """
        return await self._call(Call("DELETE", f"/v1/maps/{segment(map)}/loops/{segment(loop)}", answer=models.LoopRevoked))

    async def bring_model_verdict(self, map: str, body: models.ModelVerdict | Mapping[str, Any]) -> models.ModelVerdictAnswer:
        """Bring what a model said. A level or a merged text of texts of one class, or the description of a
        detection's crop: it is applied as if a model of this server had said it, and asks none. So a
        copy of a map, or a model that runs elsewhere, brings its verdicts. Where no anchor carries the
        texts, or the crop was read for good, it changes nothing.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/model-verdicts", body=body, answer=models.ModelVerdictAnswer))

    async def correct_poses(self, map: str, body: models.PosesBody | Mapping[str, Any]) -> models.PosesAnswer:
        """Correct poses and map points. After a loop was closed and the client has optimised: all of it in
        one transaction, or nothing. Boxes of anchors follow their points.
        """
        return await self._call(Call("POST", f"/v1/maps/{segment(map)}/poses", body=body, answer=models.PosesAnswer))

    async def get_trajectory(self, map: str, *, format: str, session: str | None = None) -> str:
        """Read a trajectory. Poses (`map_from_camera`) as last corrected, by stamp. `tum`: lines of
        `seconds x y z qx qy qz qw`. `kitti`: lines of twelve numbers, the upper rows of the pose.
        `g2o`: a pose graph of all sessions, each in its own frame: keyframes are vertices, neighbours
        of a session are joined as far apart as they are now, and confirmed loops by the transformation
        of their `query`, with the information that its `covariance` leaves. A loop whose query is not
        kept, or verified no full transformation, is a comment. Information is in metres and radians, as
        gtsam and Ceres read it.
        """
        return await self._call(Call("GET", f"/v1/maps/{segment(map)}/trajectory", query={"format": format, "session": session}, answer=str))

    async def information(self, body: models.OneText | Mapping[str, Any]) -> models.LevelAnswer:
        """InformationLevel of a description. 1 says nothing, 5 an identifier in context."""
        return await self._call(Call("POST", "/v1/semantics/information", body=body, answer=models.LevelAnswer))

    async def merge_text(self, body: models.TextPair | Mapping[str, Any]) -> models.MergeAnswer:
        """MergeText of two descriptions. One description of what both describe."""
        return await self._call(Call("POST", "/v1/semantics/merge", body=body, answer=models.MergeAnswer))

    async def similarity(self, body: models.TextPair | Mapping[str, Any]) -> models.LevelAnswer:
        """SimilarityLevel of two descriptions. 1 different objects, 5 the same."""
        return await self._call(Call("POST", "/v1/semantics/similarity", body=body, answer=models.LevelAnswer))

    async def get_usage(self) -> models.Usage:
        """Read the usage of models. Calls, tokens and cost since the database was made, and how today
        stands against its limits.
        """
        return await self._call(Call("GET", "/v1/usage", answer=models.Usage))

    async def get_version(self) -> models.Version:
        """Read the server's version. With that of the SQLite inside it."""
        return await self._call(Call("GET", "/version", answer=models.Version))
