"""Shapes of requests and answers. Made from the API document by tools/generate.py: do not edit."""

from __future__ import annotations

from typing import Any

import msgspec

from .open_enum import OpenEnum


class AnchorChangeKind(OpenEnum):
    """A change of an anchor."""

    ADDED = "added"
    REMOVED = "removed"
    DESCRIBED = "described"
    RETIRED = "retired"
    RETURNED = "returned"


class AnchorState(OpenEnum):
    """The progress of an anchor's description."""

    PENDING = "pending"
    """Nothing has described it yet."""
    VALID = "valid"
    """Its description says enough to tell it from others (§IV-B)."""
    UNINFORMATIVE = "uninformative"
    """Its description says too little."""
    RETIRED = "retired"
    """The sign hangs there no longer: three passages had it in view and did not see it
    (`signs_may_change`, M18). It takes part in no comparison, and can be listed.
    """


class Assumption(OpenEnum):
    """An assumption under which a pose holds."""

    UPRIGHT = "upright"
    """Both cameras are equally upright: neither side told the direction of gravity."""


class CandidateVerdict(OpenEnum):
    """The decision on one candidate."""

    LOOP = "loop"
    """It passed every check that could run."""
    UNDECIDED = "undecided"
    """Missing facts could turn the answer."""
    REJECTED = "rejected"
    """A check stopped it."""


class Channel(OpenEnum):
    """A way in which candidates are found."""

    BOW = "bow"
    """Bag of words (§V, check 2)."""
    ANCHORS = "anchors"
    """An anchor seen before, on another passage (§III)."""
    GLOBAL_ = "global"
    """Global descriptors that are alike."""


class DetectionRange(OpenEnum):
    """Values of `range` in Detection."""

    MEASURED = "measured"
    ASSUMED = "assumed"


class ErasureState(OpenEnum):
    """The state of an erasure."""

    REMOVING = "removing"
    """What is to be erased is being removed from the map and its releases."""
    REWRITING = "rewriting"
    """It is removed, and the database's file is being rewritten without it."""
    DONE = "done"
    """No byte of it is left in the database and its log."""


class EventKind(OpenEnum):
    """The kinds of events."""

    KEYFRAME_STORED = "keyframe_stored"
    """A keyframe arrived."""
    KEYFRAME_REMOVED = "keyframe_removed"
    """A keyframe was deleted."""
    POSES_CORRECTED = "poses_corrected"
    """A client corrected poses or map points of a session."""
    ANCHOR_DESCRIBED = "anchor_described"
    """An anchor has a description, or another one than before."""
    ANCHORS_MATCHED = "anchors_matched"
    """Two anchors match though their keyframes are not covisible: the robot has come back (§III)."""
    ANCHORS_MERGED = "anchors_merged"
    """Two anchors became one."""
    ANCHOR_RETIRED = "anchor_retired"
    """A sign hangs there no longer."""
    LOOP_FOUND = "loop_found"
    """A keyframe that arrived is a loop."""
    LOOP_REJECTED = "loop_rejected"
    """A keyframe that arrived looks like a place, and evidence speaks against it. The first of a row of
    such keyframes of a session is told; `GET .../loop-queries` lists each.
    """
    LOOP_CONFIRMED = "loop_confirmed"
    """A client closed a loop."""
    LOOP_REVOKED = "loop_revoked"
    """A client took a loop back."""
    LOOP_SUSPECTED = "loop_suspected"
    """A confirmed loop contradicts the others."""
    SESSIONS_MERGED = "sessions_merged"
    """The keyframes of a session are of another one now."""
    MERGE_REVOKED = "merge_revoked"
    """A merge of sessions was taken back."""
    RELEASE_PUBLISHED = "release_published"
    """The map was published under a name."""


class EvidenceKind(OpenEnum):
    """The kind of a term of the sum of evidence for a place (M64)."""

    NAME = "name"
    """A sign with a name is read here and there, and hangs in one place."""
    SHARED_NAME = "shared_name"
    """The same, of a name that hangs in several places: it tells none of them."""
    OTHER_NAME = "other_name"
    """At one spot two names are read that exclude each other."""
    STRANGE_NAMES = "strange_names"
    """Around the one and around the other names are read that the other has not, wherever they hang."""
    ABSENT = "absent"
    """Signs of the query that nobody read at the candidate."""
    DISPLACED_NAME = "displaced_name"
    """A name is read here and there, and would hang in two places."""
    TEXTS = "texts"
    """Pictures, notices and other texts agree. A copy of the place would show them, too."""
    VIEW = "view"
    """Geometry explains part of the view. A copy of the place would look the same."""
    NO_VIEW = "no_view"
    """Geometry finds no common view."""
    APART = "apart"
    """By the transformation the two cameras are farther apart than a place is wide."""
    ODOMETRY = "odometry"
    """Odometry has the robot here, or elsewhere."""
    COPY = "copy"
    """Looks, pictures, notices and views together prove no more than that there is no copy of this place."""
    NEIGHBOUR = "neighbour"
    """Names tell it from far places, and not from the place next to it."""
    RIVAL = "rival"
    """Another place of the map is as likely."""
    UNREAD = "unread"
    """Crops that nobody has read yet may speak against it."""


class GeometryModel(OpenEnum):
    """A model of the relation between two views."""

    SIM3 = "sim3"
    SE3 = "se3"
    ESSENTIAL = "essential"
    HOMOGRAPHY = "homography"
    ROTATION = "rotation"


class GeometryStatus(OpenEnum):
    """The status of a geometric verification."""

    SKIPPED = "skipped"
    """It did not run; `reason` says why."""
    FAILED = "failed"
    """It ran and found no transformation that explains enough."""
    VERIFIED = "verified"
    """It ran and found one."""


class GlobalEncoding(OpenEnum):
    """The form of a global descriptor's numbers, and so the measure of their likeness."""

    INT8 = "int8"
    """Signed bytes, compared by the cosine of their angle."""
    BITS = "bits"
    """Bits, compared by how many are equal."""


class IgnoredReason(OpenEnum):
    """The reason why a detection feeds no anchor."""

    CLASS_NOT_ANCHORED = "class_not_anchored"
    """The map's `anchor_classes` do not name its class."""
    NO_PLACE = "no_place"
    """It has neither map points nor a position."""
    ANCHOR_DELETED = "anchor_deleted"
    """An operator deleted the anchor it fed."""


class JudgementAsks(OpenEnum):
    """The verdicts that a job asks for again."""

    ALL = "all"
    """The default: all of them."""
    TEXTS = "texts"
    """Those about texts: levels and merged texts."""
    CROPS = "crops"
    """The descriptions of crops."""


class JudgementState(OpenEnum):
    """`preview`: only counted. `running`. `waiting`: running, while no model can be asked (none is
    configured, it is away, or the day's budget is spent). `done`. `stopped`: by DELETE.
    """

    PREVIEW = "preview"
    RUNNING = "running"
    WAITING = "waiting"
    DONE = "done"
    STOPPED = "stopped"


class KeyBodyActions(OpenEnum):
    """Values of `actions` in KeyBody."""

    READ = "read"
    """Read maps and what is in them."""
    WRITE = "write"
    """Change them."""
    QUERY = "query"
    """Ask: loop queries, and the three functions about texts."""
    ADMIN = "admin"
    """Keys and backups."""


class KeyframeChangeKind(OpenEnum):
    """A change of a keyframe."""

    ADDED = "added"
    REMOVED = "removed"
    MOVED = "moved"


class LocationVerdict(OpenEnum):
    """The answer to 'where am I?', and the standing of one place in it."""

    LOCATED = "located"
    """The place is known: the confidence is at least 0.99."""
    AMBIGUOUS = "ambiguous"
    """Several places fit, and the evidence does not tell them apart."""
    UNKNOWN = "unknown"
    """The evidence does not say where it is. The places are guesses."""


class LoopWarningCode(OpenEnum):
    """The reason why a loop that a client confirms may be wrong."""

    ANCHORS_CONTRADICT = "anchors_contradict"
    """Sure identifiers around the two keyframes contradict each other, and outweigh the signs that agree."""
    NOT_SUPPORTED = "not_supported"
    """A loop query about the two, at this version of the map, would not answer `loop`."""
    ALREADY_COVISIBLE = "already_covisible"
    """The two are covisible without this loop: the present place, or a loop confirmed before."""


class MatchKind(OpenEnum):
    """`revisit`: none of the two anchors' keyframes are covisible, the robot has come back. `covisible`:
    some are.
    """

    REVISIT = "revisit"
    COVISIBLE = "covisible"


class ModelOperation(OpenEnum):
    """The functions of §IV-A.2 (`similarity`, `information`, `merge`), and `describe`, the description of
    a crop (§IV-B).
    """

    SIMILARITY = "similarity"
    INFORMATION = "information"
    MERGE = "merge"
    DESCRIBE = "describe"


class OutcomeName(OpenEnum):
    """What can become of a detection: it founds an anchor, is one more sight of a known one, or feeds
    none.
    """

    CREATED = "created"
    OBSERVED = "observed"
    IGNORED = "ignored"


class PoseSource(OpenEnum):
    """The source of a place's pose."""

    VIEWS = "views"
    """A verified geometry between the two views, on map points."""
    ANCHORS = "anchors"
    """Matched anchors with positions."""


class RangeName(OpenEnum):
    """The origin of a position's distance."""

    MEASURED = "measured"
    ASSUMED = "assumed"


class ReasonCode(OpenEnum):
    """The check that decided; in parentheses its effect on the verdict."""

    NO_CANDIDATES = "no_candidates"
    """No keyframe shares a word with the query, and none sees an anchor that it sees (rejects)."""
    TOO_RECENT = "too_recent"
    """Keyframes taken less than `limit` s before or after the query are no candidates in this map,
    `measured` of them here, and no other one shares a word or an anchor with it (rejects).
    """
    ALREADY_CLOSED = "already_closed"
    """The loop was confirmed before, or one of the same return was that joined all that matches; no other
    keyframe is one (rejects).
    """
    EMPTY_BOW = "empty_bow"
    """No word of the query could be compared (a blank wall, or words of another vocabulary), and no anchor
    proposes a candidate (undecided).
    """
    BOW_BELOW_REFERENCE = "bow_below_reference"
    """The words score `measured`, below `limit`, the share of the reference score that this map asks for
    (rejects).
    """
    NO_ANCHORS = "no_anchors"
    """There are no described anchors to compare (depends)."""
    LLM_PENDING = "llm_pending"
    """Anchors are not described yet, and their descriptions could turn the answer. Ask again in a while
    (waits).
    """
    LLM_UNAVAILABLE = "llm_unavailable"
    """The language model is away, and its descriptions could turn the answer. Ask again in a while
    (waits).
    """
    NOT_DESCRIBED = "not_described"
    """Nothing has described some of the anchors, no model is going to, and a description could turn the
    answer (undecided).
    """
    SCORE_BELOW_THRESHOLD = "score_below_threshold"
    """The anchors around the two do not agree enough: S of Eq. (2) is `measured` and must exceed `limit`
    (rejects).
    """
    CONTRADICTION = "contradiction"
    """Names around the two exclude each other. The confidence is `measured`, and `limit` is needed
    (depends).
    """
    NOT_DISTINCTIVE = "not_distinctive"
    """Every sign that agrees hangs in several places: it could be any of them (depends)."""
    TRACKED_ONLY = "tracked_only"
    """Every sign that agrees was seen in this same passage: it was tracked, and shows no return
    (undecided).
    """
    NO_FEATURES = "no_features"
    """Geometry had to verify, and it could not run (undecided)."""
    TOO_FEW_INLIERS = "too_few_inliers"
    """Too few features fit one transformation: `measured`, and `limit` are needed (depends)."""
    ANCHORS_DISPLACED = "anchors_displaced"
    """A sign that hangs once would hang in two places if this were a loop (depends)."""
    ODOMETRY_DISAGREES_WITH_TRANSFORM = "odometry_disagrees_with_transform"
    """The robot knows from its own tracking that it is somewhere else (depends)."""
    AMBIGUOUS_PLACES = "ambiguous_places"
    """Another place of the map is about as likely (depends)."""
    PLACES_ALIKE = "places_alike"
    """Where am I: several places fit, and the confidence in the best one is `measured`; `limit` is needed.
    The signs in `look_for` would tell them apart (undecided).
    """
    TOO_LITTLE_EVIDENCE = "too_little_evidence"
    """The evidence gives a confidence of `measured`, and `limit` is needed (depends)."""


class SettingsGeometryAcceptance(OpenEnum):
    """Values of `geometry_acceptance` in Settings."""

    SIGNIFICANCE = "significance"
    COUNT = "count"


class SettingsGeometryModels(OpenEnum):
    """Values of `geometry_models` in Settings."""

    AUTO = "auto"
    SIM3 = "sim3"


class SettingsMethod(OpenEnum):
    """Values of `method` in Settings."""

    REVISIT = "revisit"
    PAPER = "paper"


class SettingsWithoutAnchors(OpenEnum):
    """Values of `without_anchors` in Settings."""

    UNDECIDED = "undecided"
    REJECT = "reject"
    GEOMETRY = "geometry"


class TextKind(OpenEnum):
    """The kind of text that a description is. A description by a model or by hand is one, whatever its
    words.
    """

    NAME = "name"
    """A name with a number: '901', 'ML D 28', 'HUB 10', also of a floor."""
    PROPER_NAME = "proper_name"
    """A proper name beside a word for what it names: 'Meeting Room Turing'."""
    NOTICE = "notice"
    """A sentence or an instruction: 'Please keep this door closed'."""
    COMMON_SIGN = "common_sign"
    """A sign of every building: EXIT."""
    DESCRIPTION = "description"
    """A description of a thing by a sentence: 'a painting of a boat'."""
    CODE = "code"
    """A code: a fiducial marker, a UUID, a link, or any text of the map's `code_classes`."""
    UNKNOWN = "unknown"
    """None of these for all that is known: a word that the lexicon does not have may be a name, a notice,
    a brand or noise.
    """


class Verdict(OpenEnum):
    """The answer to a loop query."""

    LOOP = "loop"
    """At least one candidate passed every check that could run."""
    NO_LOOP = "no_loop"
    """Every candidate was rejected, or there was none."""
    UNDECIDED = "undecided"
    """No candidate passed, and missing facts could turn the answer of at least one."""


class Verify(OpenEnum):
    """The checks that a query asks for."""

    AUTO = "auto"
    """The default: geometry where both keyframes have the features for it, else the anchors decide."""
    ANCHORS = "anchors"
    """Never geometry."""
    GEOMETRY = "geometry"
    """Geometry must verify."""


class AlignmentUncertainty(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Standard deviations of an alignment. They follow from the number of signs and how far these are
    apart.
    """

    translation_m: float
    """Of the place, in metres."""
    rotation_rad: float
    """Of the rotation about the vertical, in rad."""


class Anchor(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A semantic anchor with all that was derived about it."""

    id: str
    """Its id: given by the service, or by the client that put a prior anchor."""
    class_: str = msgspec.field(name="class")
    """Its class."""
    state: AnchorState
    """The state of its description."""
    description_source: str
    """The source of its description: `readings` (the vote over all readings), `operator`, or `plan` for a
    prior anchor.
    """
    identifiers: list[str]
    """The identifiers found in the description, such as a room's number."""
    information_level: int
    """InformationLevel of the description, 1 (says nothing) to 5 (an identifier in context)."""
    readings: list[Reading]
    """The distinct readings with their votes, heaviest first."""
    keyframes: list[str]
    """The keyframes that saw it, in order of arrival."""
    frames: list[AnchorFrame]
    """Its box in the frame of each session that saw it, oldest session first."""
    map_points: int
    """Number of its distinct map points."""
    matches: list[AnchorMatch]
    """The anchors that match it, oldest first; at most 100 of `matches_total`."""
    matches_total: int
    """Number of anchors that match it in all."""
    merged_from: list[str]
    """The anchors that go by its name."""
    has_crop: bool
    """Whether there is a crop at `.../crop`."""
    version: int
    """Grows with each fact about this anchor; the `etag` of its answers, wanted by `if-match`."""
    map_version: int | None = None
    """The map's version; left out inside a list, which says it once."""
    description: str | None = None
    """Its description, if it has one."""
    kind: TextKind | None = None
    """What kind of text that is; left out without a description."""
    information_reason: str | None = None
    """One sentence for a person that says why it has that level; left out without a description."""
    numbering: list[str] | None = None
    """The formats of the building's numbers on signs of this class, given or learned: patterns, or shapes
    such as `#.99`, in which `#` is a run of digits of any length and `9` one digit; left out while it
    is not known.
    """
    disagreement: str | None = None
    """Two readings by models or people that cannot be of one object, such as '901 is not 910'; left out if
    there are none.
    """
    box: Box | None = None
    """Its box in the frame of the oldest session that saw it; left out while its place is unknown."""
    center: list[float] | None = None
    """The box's centre, `[x,y,z]` in metres, in the same frame."""
    replaced_by: str | None = None
    """Of a retired one, the anchor that hangs in its place, if any does."""
    merged_into: str | None = None
    """The anchor whose name it goes by since they became one."""
    prior: Prior | None = None
    """What a plan says of it; left out where no plan shows it."""
    plan_position: PlanPosition | None = None
    """Its place in a plan's frame; left out where no plan shows it and no session that saw it is aligned
    to one.
    """


class AnchorChange(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An anchor that changed."""

    change: AnchorChangeKind
    """The change."""
    anchor: str
    """The anchor."""
    class_: str = msgspec.field(name="class")
    """Its class."""
    before: str | None = None
    """Its description in the release; left out where it has none."""
    after: str | None = None
    """Its description in the later version; left out where it has none."""


class AnchorFigures(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Figures of the comparison of the two local anchor maps."""

    similarity: float
    """S of Eq. (2)."""
    threshold: float
    """The threshold that S must exceed."""
    in_query: int
    """Valid anchors in the query's local map."""
    in_candidate: int
    """Valid anchors in the candidate's local map."""
    pending: int
    """Anchors of both maps that nothing has described yet."""
    contradictions: list[Contradiction]
    """The pairs that contradict."""
    matches: list[Match] | None = None
    """The pairs that match; left out with `?detail=brief`."""


class AnchorFrame(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An anchor's place in one session's frame."""

    session: str
    """The session whose frame it is."""
    box: Box
    """The anchor's box in that frame."""
    center: list[float]
    """The box's centre, `[x,y,z]` in metres."""
    range: RangeName | None = None
    """`assumed` where the distance of a sight that it is placed by was a guess; else left out."""


class AnchorList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Anchors, oldest first."""

    map_version: int
    """The map's version."""
    items: list[Anchor]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class AnchorMatch(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Another anchor with the same meaning."""

    anchor: str
    """The other anchor."""
    level: int
    """SimilarityLevel of the two descriptions, 1 (different objects) to 5 (the same)."""
    source: str
    """The judge: `identical`, `identifiers`, `lexical`, `operator` or `model:<name>`."""
    kind: MatchKind
    """Whether the two were seen apart, so that the robot has come back."""
    reason: str
    """One sentence for a person."""


class AnchorPatchBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A description by hand."""

    description: str | None
    """The description that stands from now on, whatever is read; null takes an earlier one back."""


class AskedMap(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A map that was asked."""

    map: str
    """The map."""
    map_version: int
    """The version that was asked."""
    words_compared: bool
    """Whether the words were compared: false where the map's are of another vocabulary."""


class Backup(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A backup: whole, verified, and on disk."""

    id: str
    """Its id; the file is called `ID.db`."""
    created: Time
    """The time of the request, since 1970: every write acknowledged before is in it."""
    bytes: int
    """Its size in bytes."""
    sha256: str
    """The SHA-256 of the file, in hexadecimal."""
    schema: int
    """The version of its schema."""
    maps: int
    """Maps in it."""
    keyframes: int
    """Keyframes in it."""
    anchors: int
    """Anchors in it, merged ones too."""
    removed: list[str] | None = None
    """Older backups that were removed to make room for it; in the answer to the request that took it only."""


class BackupBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A backup to be taken."""

    id: str | None = None
    """Its id; the server finds one if it is left out."""


class BackupList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Backups, the newest first."""

    items: list[Backup]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class BagOfWords(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A bag of words: two lists in parallel, in any order."""

    words: list[int]
    """The words, none twice."""
    weights: list[float]
    """Their weights, without unit; normalised to sum to one on arrival."""
    vocabulary: str | None = None
    """Whose words these are, such as a vocabulary's fingerprint. Words of two vocabularies do not go into
    one map.
    """


class BowFigures(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Figures of the bag-of-words check."""

    score: float
    """DBoW2's L1 score, 0 to 1."""
    common_words: int
    """Number of words that the two keyframes share."""
    reference_score: float
    """The lowest score of the query against its covisible keyframes, 0 without any."""


class Box(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An axis-aligned box, in metres; it may be flat."""

    min: list[float]
    """The corner with the smallest `[x,y,z]`."""
    max: list[float]
    """The corner with the largest `[x,y,z]`."""


class BulkItem(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One line of a bulk request: a keyframe with its id."""

    stamp: Time
    """When it was taken."""
    pose: Transform
    """`map_from_camera` in the session's frame, in metres; the camera looks along z, x is right and y
    down.
    """
    id: str
    """An id, made by the client."""
    session: str | None = None
    """One robot's run: its own frame and its own numbering of map points."""
    camera: Camera | None = None
    """The undistorted pinhole camera."""
    gravity: list[float] | None = None
    """The unit vector of gravity in the camera frame, where the client knows it: `[0,1,0]` for a camera
    held upright.
    """
    height_m: float | None = None
    """The height that a barometer tells, in metres above a level of the session's own: it sees a lift that
    odometry does not. Stored and answered; no verdict rests on it yet.
    """
    bow: SentBagOfWords | None = None
    """The bag of words; left out or empty for a blank wall."""
    global_descriptor: GlobalDescriptor | None = None
    """The vector of the whole image, by a model that the client ran."""
    features: SentFeatures | None = None
    """Binary features."""
    map_points: SentMapPoints | None = None
    """Map points new or moved; the order does not matter, and answers list them by number."""
    observes: list[int] | None = None
    """Map points observed, besides those of `features.map_points`; the order does not matter."""
    observes_i64: str | None = None
    """The same, packed: base64 of little-endian 64-bit signed numbers."""
    covisible: list[CovisibleKeyframe] | None = None
    """Covisible keyframes known to the client, also across sessions; each must exist. An empty list says
    that there are none. Left out, and without map points: the keyframes near along the drive count as
    covisible (`covisibility_max_way_m`).
    """
    detections: list[Detection] | None = None
    """The objects detected in it."""


class BulkLine(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The outcome of one line of a bulk request."""

    line: int
    """The line's number in the request, from 1, blank lines counted."""
    status: int
    """The HTTP status that a request of its own would have got."""
    id: str | None = None
    """The keyframe's id; left out where the line has none that can be read."""
    idempotent_replayed: bool | None = None
    """Whether the same keyframe was stored before."""
    map_version: int | None = None
    """The map's version after it."""
    covisible: int | None = None
    """Number of keyframes covisible with it."""
    detections: list[DetectionOutcome] | None = None
    """The outcomes of its detections, in their order."""
    problem: Problem | None = None
    """The reason for its refusal."""


class Camera(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A pinhole camera; keypoints and boxes are undistorted too."""

    fx: float
    """Focal length along x, in pixels."""
    fy: float
    """Focal length along y, in pixels."""
    cx: float
    """Principal point, x, in pixels."""
    cy: float
    """Principal point, y, in pixels."""
    width: int
    """Image width, in pixels."""
    height: int
    """Image height, in pixels."""


class Candidate(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe that was compared with the query."""

    keyframe: str
    """The candidate."""
    verdict: CandidateVerdict
    """The outcome of its checks."""
    geometry: Geometry
    """Geometry."""
    channel: list[Channel] | None = None
    """The channels that proposed it, where the query has a global descriptor; else left out."""
    global_: GlobalFigures | None = msgspec.field(default=None, name="global")
    """Global descriptors, where both keyframes have one."""
    bow: BowFigures | None = None
    """Bag of words; left out where `channel` is `global` alone."""
    anchors: AnchorFigures | None = None
    """Local anchor maps, if it came so far."""
    confidence: float | None = None
    """The confidence that the query was taken there, 0 to 1; left out under `'method': 'paper'`."""
    evidence: list[Evidence] | None = None
    """The terms of the sum of evidence; left out where there are none."""
    reason: Reason | None = None
    """The check that stopped it; left out for a loop."""


class ChangedKeyframe(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The map points and covisible keyframes of a keyframe, as the robot's map has them now. Long lists
    may be packed.
    """

    keyframe: str
    """The keyframe."""
    observes: list[int] | None = None
    """All map points that it observes, those of its features included; a feature whose point is not listed
    observes none. Left out: what it observed, as far as points were not fused or culled.
    """
    observes_i64: str | None = None
    """The same, packed: base64 of little-endian 64-bit signed numbers."""
    covisible: list[CovisibleKeyframe] | None = None
    """Covisible keyframes besides those declared before, or with another number of shared points; each
    must exist.
    """


class ConfirmedLoop(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A confirmed loop of the keyframe that was asked about."""

    loop: str
    """The loop."""
    keyframe: str
    """The keyframe at its other end."""


class Contradiction(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A pair of anchors whose sure identifiers exclude each other at the same relative place."""

    query_anchor: str
    """The anchor of the query's local map."""
    candidate_anchor: str
    """The anchor of the candidate's local map."""
    reason: str
    """One sentence for a person."""
    weight: float
    """The pair's two weights together, in 1/m."""


class CovisibleKeyframe(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A covisible keyframe as a client declares it."""

    keyframe: str
    """The other keyframe; it must exist."""
    shared: int
    """How many map points the two share; it counts whatever it is."""


class CovisibleList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Covisible keyframes; this list comes in one part."""

    map_version: int
    """The map's version."""
    items: list[CovisibleView]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class CovisibleView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe that is covisible with another."""

    keyframe: str
    """The other keyframe."""
    shared: int
    """How many map points they share: by observation, or as declared."""


class Detection(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An object detected in a keyframe."""

    class_: str = msgspec.field(name="class")
    """The object's class, such as `door_number`; printable."""
    confidence: float
    """The detector's confidence."""
    box: list[float]
    """`[x0,y0,x1,y1]` in pixels, x0 <= x1 and y0 <= y1; it may reach out of the image."""
    map_points: list[int] | None = None
    """The map points that the box covers: the object's place."""
    position: list[float] | None = None
    """Where the object stands in the session's frame, in metres; serves where it has no map points."""
    range: DetectionRange | None = None
    """The origin of a position's distance."""
    text: str | None = None
    """What a reader made of it."""
    description: str | None = None
    """What a model or a person made of it; wins over `text`."""
    crop: str | None = None
    """The image inside the box, PNG or JPEG of at most 4 MiB, in base64."""


class DetectionOutcome(msgspec.Struct, kw_only=True, omit_defaults=True):
    """What became of a detection."""

    outcome: OutcomeName
    """What became of it."""
    anchor: str | None = None
    """The anchor that it feeds."""
    reason: IgnoredReason | None = None
    """Why it was ignored."""
    state: AnchorState | None = None
    """How far the anchor's description is."""


class DetectionView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A detection as stored; its crop is read through its anchor."""

    class_: str = msgspec.field(name="class")
    """The object's class."""
    confidence: float
    """The detector's confidence, 0 to 1."""
    box: list[float]
    """`[x0,y0,x1,y1]`, in pixels."""
    map_points: list[int]
    """The map points that the box covers, ascending."""
    has_crop: bool
    """Whether a crop came with it."""
    outcome: OutcomeName
    """What became of it."""
    position: list[float] | None = None
    """Where the object stands in the session's frame, in metres."""
    range: DetectionRange | None = None
    """The origin of a position's distance."""
    text: str | None = None
    """What a reader made of it."""
    description: str | None = None
    """What a model or a person made of it."""
    anchor: str | None = None
    """The anchor that it feeds."""
    reason: IgnoredReason | None = None
    """Why it was ignored."""
    state: AnchorState | None = None
    """How far the anchor's description is."""


class Erasure(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An erasure, as far as it has come."""

    id: str
    """Its id."""
    state: ErasureState
    """Its state. It goes on after a restart, until it is `done`."""
    keyframes: int
    """Number of keyframes that were removed from the map."""
    releases: int
    """Number of releases that keyframes were removed from."""
    begun: Time
    """When it was asked for."""
    older_backups: list[str]
    """The backups in the server's folder that were taken before it was done, and still hold what it
    erased.
    """
    ended: Time | None = None
    """When it was done; left out before that."""


class ErasureBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """What is to be erased. Exactly one of `keyframes` and `sessions`."""

    keyframes: list[str] | None = None
    """Keyframes, by id. One that the map does not have any more is erased from its releases, and from what
    is left of it.
    """
    sessions: list[str] | None = None
    """Whole sessions, by name."""


class Event(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One event: the `data` of a server-sent event whose `id` is `seq`. It is flat; what a kind does not
    speak of is left out.
    """

    seq: int
    """Its number in its map, growing by one."""
    event: EventKind
    """The kind of event."""
    map_version: int
    """The map's version in which it happened."""
    time: Time | None = None
    """When it happened, by the server's clock."""
    anchor: str | None = None
    """The anchor it is about; of two that merged, the one whose name both go by."""
    other: str | None = None
    """The other anchor."""
    keyframe: str | None = None
    """The keyframe that came back."""
    candidate: str | None = None
    """The keyframe it came back to."""
    loop: str | None = None
    """The loop it is about."""
    query: str | None = None
    """The loop query that found it."""
    session: str | None = None
    """The session that merged into another one."""
    into: str | None = None
    """The session that it merged into."""
    detail: str | None = None
    """The description, or one sentence for a person."""


class Evidence(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One term of the sum of evidence for a place."""

    kind: EvidenceKind
    """Its kind."""
    about: str
    """The signs, cells or metres that it rests on, for a person."""
    log_odds: float
    """Its natural log-odds, positive for the place."""
    query_anchors: list[str] | None = None
    """The query's anchors that it rests on; left out where there are none."""
    candidate_anchors: list[str] | None = None
    """The candidate's, in the same order."""


class Fault(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One fault of a request."""

    pointer: str
    """JSON pointer into the body (`/detections/0/box`), a query parameter (`?limit`), a part of the path
    (`{map}`) or a header (`if-match:`).
    """
    detail: str
    """Description of the fault."""
    got: str | None = None
    """The value that was sent, shortened."""
    limit: str | None = None
    """The values that are allowed."""


class Features(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Binary features: three lists in parallel."""

    descriptor_bytes: int
    """Bytes of one descriptor: 32 for ORB, 64 for BRISK."""
    descriptors: str
    """The descriptors one after the other, in base64."""
    keypoints: list[list[float]]
    """One for each descriptor: `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`, in pixels, pyramid
    level and degrees. Packed, an angle that is not a number is none.
    """
    map_points: list[int] | None = None
    """The map point that each feature observes, -1 for none; left out if none does."""


class Frame(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A session in the frame of the reference."""

    session: str
    """The session."""
    loops: int
    """Number of its loops with other sessions that count."""
    reference_from_session: Transform | None = None
    """Maps points of its frame into that of the reference; left out if no loop and no plan joins the two."""
    residual: float | None = None
    """Root mean square of what its loops are off from the frames, in metres; left out without any. Frames
    are rigid, so that drift within a session shows here.
    """


class Frames(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One frame for all sessions of a map."""

    version: int
    """The map's version that it was computed at. While what loops and plans say stays the same, so does
    it.
    """
    frames: list[Frame]
    """The sessions, in order of appearance."""
    suspects: list[Suspect]
    """The confirmed loops that contradict the others, by id."""
    loops: int
    """Number of confirmed loops between sessions that count."""
    left_out: int
    """Number of confirmed loops between sessions without a transformation."""
    reference: str | None = None
    """The session in whose frame the others are; left out in a map without sessions."""


class Geometry(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The result of geometric verification."""

    status: GeometryStatus
    """Its outcome."""
    reason: str | None = None
    """The reason why it was skipped or failed, for a person; left out where a check before it decided."""
    model: GeometryModel | None = None
    """The model that was looked for. Where too few points are triangulated the images alone are compared,
    by the simplest model that explains nearly as much as the others.
    """
    matches: int | None = None
    """Descriptor matches; for `sim3` and `se3` between features with triangulated map points on both
    sides.
    """
    hypotheses: int | None = None
    """Samples that RANSAC drew."""
    inliers: int | None = None
    """Matches that the final transformation explains, after the guided search."""
    log10_false_alarms: float | None = None
    """The decimal logarithm of the number of false alarms: how often matches placed at random in the
    images would give a model with as many inliers. At most -6 is significant.
    """
    mean_reprojection_error_px: float | None = None
    """The inliers' mean reprojection error in both images, in pixels."""
    candidate_from_query: Similarity | None = None
    """Maps points of the query's camera frame into the candidate's camera frame. For `essential` and
    `homography` the translation's length is not known and given as 1; for `rotation` nothing of the
    translation is known, and it is given as 0. A homography that leaves two motions has none.
    """
    covariance: list[float] | None = None
    """The covariance of `candidate_from_query` where `sim3` or `se3` is verified, row by row: x, y, z in
    metres and the rotation about X, Y, Z in radians, in the candidate's camera frame, as ROS writes it.
    It says how the inliers scatter; drift that all of them share does not show in it.
    """


class GlobalDescriptor(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One vector of a whole image, by a model that the client ran. The first one of a map decides: all of
    them have one model, one encoding and one size.
    """

    model: str
    """The model that computed it, with all that changes its numbers, such as a version."""
    encoding: GlobalEncoding
    """The form of its numbers."""
    data: str
    """The numbers one after the other, in base64: 1 to 1,056 bytes."""


class GlobalFigures(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Figures of the comparison of the two global descriptors."""

    similarity: float
    """The cosine of the two vectors, 0 where it is negative; bits count as 1 and -1."""


class Health(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The state of the server."""

    status: str
    """`alive`, `ready` or `degraded`; a server that is not ready answers a problem."""
    detail: str | None = None
    """One sentence for a person, if it is degraded: why."""


class Judgement(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A job that asks again, as it stands."""

    map_version: int
    """The map's version."""
    state: JudgementState
    """Its state."""
    asks: JudgementAsks
    """The verdicts that it asks for again."""
    questions: int
    """Questions that other models or prompts answered than those configured now, as counted when the job
    began.
    """
    calls_max: int
    """The most calls of models that they may take; answers that are kept take none."""
    cost_max_usd: float
    """The most that these calls may cost, in US dollars."""
    changed: int
    """Questions answered otherwise than before."""
    unchanged: int
    """Questions answered as before."""
    gone: int
    """Questions about something that the map no longer holds."""
    failed: int
    """Questions that the model did not answer, though it answered others; their verdicts stand."""
    left: int
    """Questions that are left."""
    replaced: list[ReplacedVerdict]
    """Verdicts that were replaced by others since the job began, the newest first, at most 100 of them."""
    id: str | None = None
    """Its id; left out of a preview."""


class JudgementBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A job to be started, or to be counted first."""

    id: str | None = None
    """Its id; the server finds one if it is left out."""
    asks: JudgementAsks | None = None
    """The verdicts to ask for again."""
    preview: bool | None = None
    """Only counts the questions and what they may cost, and starts nothing."""


class KeyBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A key to be made."""

    actions: list[KeyBodyActions]
    """Its permissions, at least one."""
    name: str | None = None
    """Whose it is, for people."""
    maps: list[str] | None = None
    """The maps that exist for it: ids in which `*` stands for any characters. Left out: every map."""
    expires: Time | None = None
    """From when on it is no longer good. Left out: never."""
    rate_per_s: int | None = None
    """Requests a second; a second's worth may come at once, and a bulk line counts as a request. Left out:
    any number.
    """
    max_maps: int | None = None
    """Maximum maps that it made and that exist: it cannot make more (507). Left out: any number."""
    max_bytes: int | None = None
    """Maximum bytes of these maps, with their releases: what would add to them is refused (507), whoever
    sends it. What they hold is looked up once a second. Left out: any number.
    """
    model_daily_calls: int | None = None
    """Calls of models a day (UTC) for the maps it makes and the texts it asks about. Left out: any number."""
    model_daily_usd: float | None = None
    """Maximum cost of these calls, in US dollars. Left out: any sum."""


class KeyList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Keys, in order of creation, revoked ones among them."""

    items: list[KeyView]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class KeyView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A key, without its secret."""

    id: str
    """Its id, `key-7`."""
    name: str
    """Whose it is."""
    actions: list[KeyBodyActions]
    """Its permissions."""
    maps: list[str]
    """The maps that exist for it."""
    created: Time
    """The time when it was made."""
    expires: Time | None = None
    """From when on it is no longer good; left out if it does not expire."""
    revoked: Time | None = None
    """The time when it was revoked; left out while it is good."""
    rate_per_s: int | None = None
    """Requests a second."""
    max_maps: int | None = None
    """Maximum maps that it made and that exist."""
    max_bytes: int | None = None
    """Maximum bytes of these maps with their releases."""
    model_daily_calls: int | None = None
    """Calls of models a day."""
    model_daily_usd: float | None = None
    """Maximum cost of these calls, in US dollars."""
    last_used: Time | None = None
    """When the server that answers was last asked with it; left out if it was not since that server
    started.
    """
    secret: str | None = None
    """The secret, to be sent as `authorization: Bearer <secret>`. Shown once, when the key is made, and
    kept nowhere.
    """
    notice: str | None = None
    """The consequences, if this is the server's first key."""


class Keyframe(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe to be stored, or asked about without being stored. Only `stamp` and `pose` are required.
    Long lists may be packed.
    """

    stamp: Time
    """When it was taken."""
    pose: Transform
    """`map_from_camera` in the session's frame, in metres; the camera looks along z, x is right and y
    down.
    """
    session: str | None = None
    """One robot's run: its own frame and its own numbering of map points."""
    camera: Camera | None = None
    """The undistorted pinhole camera."""
    gravity: list[float] | None = None
    """The unit vector of gravity in the camera frame, where the client knows it: `[0,1,0]` for a camera
    held upright.
    """
    height_m: float | None = None
    """The height that a barometer tells, in metres above a level of the session's own: it sees a lift that
    odometry does not. Stored and answered; no verdict rests on it yet.
    """
    bow: SentBagOfWords | None = None
    """The bag of words; left out or empty for a blank wall."""
    global_descriptor: GlobalDescriptor | None = None
    """The vector of the whole image, by a model that the client ran."""
    features: SentFeatures | None = None
    """Binary features."""
    map_points: SentMapPoints | None = None
    """Map points new or moved; the order does not matter, and answers list them by number."""
    observes: list[int] | None = None
    """Map points observed, besides those of `features.map_points`; the order does not matter."""
    observes_i64: str | None = None
    """The same, packed: base64 of little-endian 64-bit signed numbers."""
    covisible: list[CovisibleKeyframe] | None = None
    """Covisible keyframes known to the client, also across sessions; each must exist. An empty list says
    that there are none. Left out, and without map points: the keyframes near along the drive count as
    covisible (`covisibility_max_way_m`).
    """
    detections: list[Detection] | None = None
    """The objects detected in it."""


class KeyframeAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe is stored."""

    keyframe: str
    """Its id."""
    map_version: int
    """The map's version after it."""
    covisible: int
    """How many keyframes are covisible with it."""
    detections: list[DetectionOutcome]
    """What became of its detections, in their order."""
    notice: str | None = None
    """The consequence of it, where nothing joins it with the others of its session; else left out."""
    loop: LoopAnswer | None = None
    """The answer to the loop query, if the request asked it."""


class KeyframeChange(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe that changed."""

    change: KeyframeChangeKind
    """The change."""
    keyframe: str
    """The keyframe."""
    moved_m: float | None = None
    """How far it moved, in metres; left out where it did not."""


class KeyframeLine(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A line of the list of keyframes."""

    id: str
    """Its id."""
    session: str
    """Its session."""
    stamp: Time
    """When it was taken."""
    pose: Transform
    """`map_from_camera` in the session's frame, in metres, as last corrected."""
    covisible: int
    """How many keyframes are covisible with it."""
    anchors: list[str]
    """The anchors it sees."""


class KeyframeList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Keyframes, in order of arrival."""

    map_version: int
    """The map's version."""
    items: list[KeyframeLine]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class KeyframeView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe as it stands now: what was sent, as last corrected, and what became of it."""

    id: str
    """Its id."""
    map_version: int
    """The map's version."""
    session: str
    """Its session."""
    stamp: Time
    """When it was taken."""
    pose: Transform
    """`map_from_camera` in the session's frame, in metres, as last corrected."""
    bow: BagOfWords
    """The bag of words, words ascending, weights summing to one."""
    map_points: MapPoints
    """The map points it brought, at their present positions."""
    observes: list[int]
    """Every map point it observes, ascending."""
    covisible: list[CovisibleKeyframe]
    """The covisible keyframes that its client declared; all of them are listed at `.../covisible`."""
    covisible_total: int
    """The number of keyframes that are covisible with it: by shared points, by declaration, by a confirmed
    loop or along the drive.
    """
    detections: list[DetectionView]
    """Its detections, each with what became of it."""
    camera: Camera | None = None
    """The camera."""
    gravity: list[float] | None = None
    """The unit vector of gravity in the camera frame, as sent."""
    height_m: float | None = None
    """The height that a barometer tells, in metres, as sent."""
    global_descriptor: GlobalDescriptor | None = None
    """The vector of the whole image."""
    features: Features | None = None
    """The features."""


class LevelAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """SimilarityLevel or InformationLevel."""

    level: int
    """1 to 5. Similarity: 1 different objects, 5 the same. Information: 1 says nothing, 5 an identifier in
    context.
    """
    source: str
    """The judge: `identical`, `identifiers`, `lexical`, `operator` or `model:<name>`."""
    reason: str
    """One sentence for a person."""
    cached: bool
    """Whether the answer came from a cache of model answers."""
    degraded: bool
    """Whether the built-in judge stood in because a model was away."""


class ListedVerdict(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A verdict in a line, as the list shows it."""

    query: str
    """The query's id."""
    time: Time
    """When it was asked last, by the server's clock."""
    keyframe: str | None
    """The keyframe that was asked about; null where it came with the query."""
    session: str | None
    """The session of that keyframe, while the map has it."""
    candidate: str | None
    """The keyframe it came back to, or else the likeliest one."""
    map_version: int
    """The map's version that answered."""
    verdict: Verdict
    """The answer."""
    why: str
    """One sentence for a person: why."""
    is_whole: bool
    """Whether `GET .../loop-queries/{query}` still returns the whole answer."""
    reason: ReasonCode | None = None
    """The check that decided, of the answer or else of the likeliest candidate; left out for a loop."""


class LocalAnchor(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An anchor as seen from a central keyframe."""

    anchor: str
    """The anchor."""
    class_: str = msgspec.field(name="class")
    """Its class."""
    state: AnchorState
    """The state of its description; only valid ones count in S."""
    bearing: list[float]
    """Unit vector towards its centre in the camera's frame, `[x,y,z]`: right, down, forward."""
    distance_m: float
    """Its distance, in metres."""
    weight: float
    """Its weight in Eq. (2), in 1/m."""
    description: str | None = None
    """Its description, if it has one."""
    kind: TextKind | None = None
    """What kind of text that is; left out without a description."""


class LocalAnchorMap(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The local anchor map M_k of §V-A."""

    keyframe: str
    """The central keyframe."""
    map_version: int
    """The map's version."""
    anchors: list[LocalAnchor]
    """The anchors that the keyframe and those covisible with it see."""


class LocateAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The answer to 'where am I?'. The same versions of the maps, the same question and seed give the same
    bytes.
    """

    verdict: LocationVerdict
    """The answer."""
    confidence: float
    """The confidence that the camera is at the first place, 0 to 1; `located` is at least 0.99."""
    places: list[Place]
    """The places, best first. Where the verdict is not `located`, they are guesses."""
    look_for: list[LookFor]
    """Where places are ambiguous: the signs that would tell them apart."""
    maps: list[AskedMap]
    """The maps that were asked, by name."""
    why: str | None = None
    """One sentence for a person: why."""
    reason: Reason | None = None
    """Why there is no place, or why the first one is not certain."""


class LocateBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """'Where am I?' Exactly one of `keyframe` and `keyframes`."""

    keyframe: UnplacedKeyframe | None = None
    """What the camera sees."""
    keyframes: list[UnplacedKeyframe] | None = None
    """What the camera sees in one moment or on one short drive. With a `pose` each, all in one frame,
    their signs are compared together. The answer's poses are those of the first one.
    """
    maps: list[str] | None = None
    """The maps to ask, as ids in which `*` stands for any characters; at most 64 maps. Left out: every map
    that the key may query.
    """
    release: str | None = None
    """The release of each map that is asked; maps without a release of this name are left out, and one
    that `maps` names must have it. Left out: the maps as they stand.
    """
    hint: LocateHint | None = None
    """A guess. It decides what is looked at first, and never what the answer is."""
    exclude: LocateExclude | None = None
    """Keyframes that are no candidates, say those of the robot's own drive."""
    max: int | None = None
    """Maximum number of places in the answer."""
    seed: int | None = None
    """The seed of what is drawn at random."""


class LocateExclude(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Keyframes that are no candidates, in any map."""

    keyframes: list[str] | None = None
    """Keyframes, by id; those that a map does not have are ignored."""
    sessions: list[str] | None = None
    """Whole sessions, by name."""


class LocateHint(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A guess where the camera is."""

    map: str | None = None
    """The map, say that of the floor at which the lift stopped."""
    position: list[float] | None = None
    """`[x,y,z]` in the frame of any of its sessions, in metres."""
    radius_m: float | None = None
    """How far from that position the camera may be, in metres."""


class LookFor(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A sign that would tell one of several places from the others."""

    class_: str = msgspec.field(name="class")
    """Its class."""
    description: str
    """Its description."""
    position: list[float]
    """`[x,y,z]` in the frame of its place's session, in metres."""
    map: str
    """The map in which it hangs."""
    session: str
    """The session in whose frame it is."""


class LoopAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The answer to 'is this keyframe a loop?'. The same map version, keyframe, settings and seed give the
    same bytes.
    """

    id: str
    """The query's id, derived from what was asked, so that it repeats too."""
    map_version: int
    """The map's version that was asked."""
    verdict: Verdict
    """The answer."""
    best: str | None
    """The keyframe to close the loop with; null unless the verdict is `loop`."""
    loops: list[str]
    """Every keyframe that passed, best first."""
    degraded: bool
    """Whether a stand-in judged because a model was away."""
    excluded_covisible: int
    """Number of keyframes that are not candidates because they are covisible with the query."""
    closed: list[ConfirmedLoop]
    """The loops of this keyframe that are confirmed already, by id, at most 100."""
    candidates: list[Candidate]
    """The candidates: loops first, then undecided, then rejected, each best first. With `?detail=brief`
    the rejected ones are left out.
    """
    keyframe: str | None = None
    """The keyframe that was asked about; left out for an inline one."""
    why: str | None = None
    """One sentence for a person: why."""
    confidence: float | None = None
    """The confidence in the best place, 0 to 1; left out under `'method': 'paper'`, and where no candidate
    was weighed.
    """
    has_twins: bool | None = None
    """Whether the map has shown one view in two places, around which different signs hang (see the map's
    `twins`). Left out where it has not.
    """
    reason: Reason | None = None
    """Why, where no candidate says it: there is none, or the loop is confirmed and no other is left."""
    look_for: list[SignToLookFor] | None = None
    """The signs that would tell where it is undecided, the nearest to the best candidate first. Left out
    where there are none.
    """


class LoopBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A loop that the client closed."""

    id: str
    """Its id."""
    keyframe: str
    """The keyframe that came back."""
    candidate: str
    """The keyframe it came back to."""
    query: str | None = None
    """The id of the loop query that found it."""
    candidate_from_query: SentSimilarity | None = None
    """The pose of the keyframe in the candidate's camera frame, as the client closed it; left out: what
    the query verified, if its answer is still stored. It joins the frames of two robots.
    """


class LoopClosed(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A loop is closed."""

    id: str
    """Its id."""
    map_version: int
    """The map's version after it."""
    merged: list[Merge]
    """The pairs of anchors that became one."""
    warnings: list[LoopWarning]
    """Evidence against it, as the map stood before it. The client decides: it is closed all the same, and
    can be revoked. A retry (200) is answered without them.
    """


class LoopList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Confirmed loops, oldest first."""

    map_version: int
    """The map's version."""
    items: list[LoopView]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class LoopQueryBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A loop query: about a stored keyframe, or about one sent along and not stored. Exactly one of
    `keyframe` and `inline`.
    """

    keyframe: str | None = None
    """The id of a stored keyframe."""
    inline: Keyframe | None = None
    """A keyframe that is not stored."""
    release: str | None = None
    """The release of the map that is asked; left out: the map as it stands. A stored keyframe must be one
    of the release.
    """
    verify: Verify | None = None
    """The checks that must run."""
    max_wait_ms: int | None = None
    """Maximum wait for models that are still judging, in milliseconds."""
    seed: int | None = None
    """The seed of what is drawn at random."""
    again: bool | None = None
    """Whether a loop that repeats a confirmed one is a `loop`, too, and not `already_closed`."""


class LoopRevoked(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A loop is revoked."""

    id: str
    """Its id."""
    map_version: int
    """The map's version after it."""
    split: list[Merge]
    """The pairs of anchors that are two again."""


class LoopView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A confirmed loop."""

    id: str
    """Its id."""
    keyframe: str
    """The keyframe that came back."""
    candidate: str
    """The keyframe it came back to."""
    merged: list[Merge]
    """The pairs of anchors that it made one."""
    query: str | None = None
    """The loop query that found it."""


class LoopWarning(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Evidence against a loop that was confirmed."""

    code: LoopWarningCode
    """The kind of evidence."""
    detail: str
    """One sentence for a person."""


class MapBase(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The map that a new one begins as."""

    map: str
    """The map."""
    release: str | None = None
    """Its release; left out: the map as it stands."""


class MapBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A map to be made."""

    description: str | None = None
    """Free text for people."""
    metric: bool | None = None
    """Whether its lengths are metres. Then the scale between two sessions is 1. If not, settings in metres
    are in the unit of the poses that it is sent.
    """
    gravity: list[float] | None = None
    """The unit vector of gravity in the frame of each of its sessions, if they have it in common:
    `[0,1,0]` where a session's frame is its first camera, held upright. Left out, it is not known; once
    given, it may be changed and not withdrawn.
    """
    anchor_classes: list[str] | None = None
    """The classes of which anchors are made; empty means every class."""
    code_classes: list[str] | None = None
    """The classes whose texts are codes, such as fiducial markers and asset numbers. Codes are compared
    exactly: case and each character count.
    """
    settings: Settings | None = None
    """The settings that differ from their defaults."""
    base: MapBase | None = None
    """What the map begins as: a copy of a release, or of a map as it stands, with its keyframes, anchors
    and loops. The other members then change what it has from there. The copy and the map go different
    ways from then on.
    """


class MapList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Maps, by id."""

    items: list[MapView]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""
    covered: list[str] | None = None
    """The maps that the key covers, as patterns; left out where it covers every map."""


class MapPatchBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Changes of a map; a field that is left out stays as it is."""

    description: str | None = None
    """Free text for people."""
    metric: bool | None = None
    """Whether its lengths are metres."""
    gravity: list[float] | None = None
    """The unit vector of gravity in the frame of each of its sessions, if they have it in common:
    `[0,1,0]` where a session's frame is its first camera, held upright. Left out, it is not known; once
    given, it may be changed and not withdrawn.
    """
    anchor_classes: list[str] | None = None
    """The classes of which anchors are made from now on; empty means every class."""
    code_classes: list[str] | None = None
    """The classes whose texts are codes, compared exactly. What was read of them before is compared so,
    too.
    """
    settings: Settings | None = None
    """The settings to be set; the others stay as they are."""


class MapPoints(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Positions of map points: two lists in parallel."""

    ids: list[int]
    """The points' numbers in their session, none twice."""
    positions: list[list[float]]
    """`[x,y,z]` of each in the session's frame, in metres."""


class MapVersion(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The map's version after a write that has nothing else to tell."""

    map_version: int
    """Grows by one with each write to the map."""


class MapView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A map at one version."""

    id: str
    """Its id."""
    map_version: int
    """Grows by one with each write to the map."""
    description: str
    """Free text for people."""
    metric: bool
    """Whether its lengths are metres."""
    anchor_classes: list[str]
    """The classes of which anchors are made, sorted; empty means every class."""
    code_classes: list[str]
    """The classes whose texts are codes, compared exactly, sorted."""
    settings: Settings
    """Every setting in force; with `?detail=brief` those that differ from their defaults."""
    keyframes: int
    """Number of its keyframes."""
    anchors: int
    """Number of its anchors, merged ones counted once."""
    sessions: int
    """Number of sessions that have written to it."""
    loops: int
    """Number of its confirmed loops."""
    bytes: int
    """Size of its facts on disk, in bytes: keyframes with their words, features, detections, texts and
    crops, map points with a position (once each, however often sent), sessions, and loops with what
    they merge.
    """
    numbering: dict[str, list[str]]
    """By class, how the building writes its numbers, as learned from ten values or more: `#` stands for
    the first run of digits, a `9` for each digit of the others (`#.99` for 7.04 and 10.01). Patterns
    that were given stand in `settings`.
    """
    twins: list[Twins]
    """The views that this map has in two places; around the two, different signs hang. Looked for where
    `without_anchors` is `geometry`.
    """
    gravity: list[float] | None = None
    """The unit vector of gravity in the frame of each of its sessions; left out while it is not known."""
    vocabulary: str | None = None
    """The vocabulary its words belong to: a fingerprint, a name that a client gave, or `client`; left out
    while it has none.
    """


class Match(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A pair of anchors that match."""

    query_anchor: str
    """The anchor of the query's local map; `inline-0` is the first detection of an inline keyframe."""
    candidate_anchor: str
    """The anchor of the candidate's local map."""
    kind: TextKind
    """The kind of the query's text."""
    level: int
    """SimilarityLevel of the two descriptions, 1 to 5."""
    source: str
    """The judge."""
    angle_difference_rad: float
    """Angle between the two bearings, in radians."""
    distance_difference_m: float
    """Difference of the two distances, in metres."""
    weight: float
    """The pair's two weights together, as Eq. (2) adds them, in 1/m."""


class Merge(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A pair of anchors."""

    into: str
    """The older anchor, by whose name both go."""
    from_: str = msgspec.field(name="from")
    """The newer anchor."""


class MergeAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """MergeText: one description out of two."""

    text: str
    """The description."""
    source: str
    """The source of the merged text: `lexical` or `model:<name>`."""
    cached: bool
    """Whether the answer came from a cache of model answers."""
    degraded: bool
    """Whether the built-in judge stood in because a model was away."""


class MergeBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The session that another one merges into, and how; all of it is taken over, or nothing."""

    into: str
    """The session that the keyframes are of from now on. One that is not there yet is begun."""
    into_from_session: SentSimilarity
    """Maps points of the session's frame into the frame of `into`."""
    map_points: Renumbering | None = None
    """The numbers that its map points get; left out, they keep theirs."""


class MergeRevokedAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The sessions are two again."""

    map_version: int
    """The map's version after it."""
    keyframes: int
    """Number of keyframes that moved back."""


class ModelVerdict(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A verdict of a model: a level or a merged text of texts of one class, or a description of a
    detection's crop.
    """

    operation: ModelOperation
    """The question."""
    source: str
    """Its source, such as `model:gpt-4o-mini`."""
    class_: str | None = msgspec.field(default=None, name="class")
    """The class of the objects that carry the texts; of all but `describe`."""
    texts: list[str] | None = None
    """The texts: two, or one for `information`; none for `describe`."""
    level: int | None = None
    """The level of `similarity` and `information`."""
    text: str | None = None
    """The text of `merge` and `describe`; empty where nothing could be made of a crop."""
    keyframe: str | None = None
    """The keyframe of the crop that was described."""
    detection: int | None = None
    """The number of the detection in it, from 0."""
    described: bool | None = None
    """Whether a model described the crop, rather than a reader of characters."""
    degraded: bool | None = None
    """Whether a reader stood in for the model: it is read again once a model is there."""
    reason: str | None = None
    """Why, in one sentence for a person."""


class ModelVerdictAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The effect of a verdict."""

    map_version: int
    """The map's version after it."""
    applied: bool
    """Whether it changed the map: not where no anchor carries the texts, or the crop was read before."""


class ObservationsAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The map follows the robot's."""

    map_version: int
    """The map's version after it."""
    keyframes: int
    """Number of keyframes that observe other points now, or have other declared neighbours."""
    map_points: int
    """Number of map points that were there and are gone, fused or culled."""
    anchors_merged: int
    """Number of anchors that turned out to be one with another."""


class ObservationsBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Changes that a robot's map made to its points and edges; all of it is taken over, or nothing.
    Everything in it is of one session.
    """

    session: str | None = None
    """The session."""
    replaced: list[list[int]] | None = None
    """Fused map points, `[old, new]` each: who observed the old one observes the new one from now on. The
    new one keeps its position, or takes the old one's. No point is fused twice; `[1,2]` and `[2,3]`
    make both of them 3.
    """
    removed: list[int] | None = None
    """Culled map points: nobody observes them any more."""
    keyframes: list[ChangedKeyframe] | None = None
    """Keyframes of the session of which there is more to say, none twice."""


class OneText(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A description of an object."""

    text: str
    """The description."""
    class_: str | None = msgspec.field(default=None, name="class")
    """The object's class."""


class Place(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A place at which the camera may be."""

    map: str
    """The map."""
    session: str
    """The session in whose frame `map_from_camera` is."""
    verdict: LocationVerdict
    """Its standing in the answer."""
    confidence: float
    """The confidence that the camera is here, 0 to 1."""
    signs: PlaceSigns
    """The signs that speak for the place and against it."""
    verified_views: int
    """Number of keyframes of this place that geometry verified."""
    keyframe: str | None = None
    """The map's keyframe that stands for the place; left out where only a plan's anchors say it."""
    asked: int | None = None
    """The number of the asked keyframe, from 0, that was taken near `keyframe`; left out where one
    keyframe asks. The pose is the first one's all the same.
    """
    evidence: list[Evidence] | None = None
    """The terms of the sum of evidence, against the strongest other place; left out where there are none."""
    map_from_camera: Transform | None = None
    """The camera's pose in the session's frame, in metres; left out where the evidence gives none."""
    plan_from_camera: Transform | None = None
    """The same in the frame of the plan to which the session is aligned."""
    plan: str | None = None
    """The plan's frame."""
    uncertainty: Uncertainty | None = None
    """The standard deviation of that pose."""
    pose_source: PoseSource | None = None
    """The source of that pose."""
    assumed: list[Assumption] | None = None
    """The assumptions that it rests on; left out where there are none."""
    channel: list[Channel] | None = None
    """The channels that proposed the keyframe, where the question has a global descriptor."""
    global_: GlobalFigures | None = msgspec.field(default=None, name="global")
    """Global descriptors."""
    bow: BowFigures | None = None
    """Bag of words."""
    anchors: AnchorFigures | None = None
    """Local anchor maps."""
    geometry: Geometry | None = None
    """Geometry."""
    reason: Reason | None = None
    """The check that stopped the keyframe as a loop candidate, if one did."""


class PlaceSigns(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The signs that speak for a place and against it."""

    agreeing: list[str]
    """The identifiers that agree and hang in one place only, as read."""
    contradicting: int
    """Number of pairs of identifiers that exclude each other at the same relative place."""


class PlanPosition(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The place of an anchor in a plan's frame."""

    frame: str
    """The plan's frame."""
    position: list[float]
    """Its position `[x,y,z]` in that frame, in metres."""
    session: str | None = None
    """The aligned session that it is known by; left out for what the plan itself shows."""


class PoseList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Keyframes and their poses: two lists in parallel."""

    ids: list[str]
    """The keyframes, none twice."""
    poses: list[Transform]
    """`map_from_camera` of each in the session's frame, in metres."""


class PosesAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Poses and points are corrected."""

    map_version: int
    """The map's version after it."""
    keyframes: int
    """Number of corrected keyframes."""
    map_points: int
    """Number of corrected map points."""


class PosesBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Corrected poses and map points of one session; all of it is taken over, or nothing."""

    session: str | None = None
    """The session."""
    keyframes: PoseList | None = None
    """Its keyframes with their corrected poses."""
    map_points: SentMapPoints | None = None
    """Its map points at their corrected positions."""


class Prior(msgspec.Struct, kw_only=True, omit_defaults=True):
    """What a plan says of an anchor."""

    frame: str
    """The plan's frame."""
    position: list[float]
    """Its position `[x,y,z]` in that frame, in metres."""
    normal: list[float] | None = None
    """The unit vector `[x,y,z]` out of the wall, if the plan says so."""
    source: str | None = None
    """Where it is known from."""


class PriorBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A sign that a plan shows."""

    class_: str = msgspec.field(name="class")
    """The class of the sign, as robots' detections name it: anchors of one class match."""
    description: str
    """The text on the sign, or its description."""
    position: list[float]
    """Its position `[x,y,z]` in the plan's frame, in metres; z points up."""
    frame: str
    """The plan's frame: the id of a session that no robot drives. Each floor has one, or one frame has
    heights.
    """
    normal: list[float] | None = None
    """The unit vector `[x,y,z]` out of the wall, towards those who read the sign, in the plan's frame; a
    norm more than 1 % off one is rejected.
    """
    source: str | None = None
    """Where it is known from, for people: the file of the plan."""


class Problem(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The reason why a request was refused, or failed."""

    type: str
    """Address of an explanation of the kind of problem."""
    title: str
    """The kind of problem in a few words."""
    status: int
    """The HTTP status."""
    detail: str
    """Description of this occurrence."""
    code: str
    """The kind of problem, for programs."""
    request_id: str
    """The request's id, as in the header `x-request-id` and in the server's log."""
    errors: list[Fault]
    """Every fault of the request at once; empty where the request itself is not at fault."""


class Quaternion(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A rotation as a unit quaternion, without unit; a norm more than 1 % off one is refused."""

    x: float
    """Imaginary part, i."""
    y: float
    """Imaginary part, j."""
    z: float
    """Imaginary part, k."""
    w: float
    """Real part."""


class Reading(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A distinct reading of an anchor."""

    text: str
    """The text, as last read."""
    weight: float
    """The sum of its detections' confidences."""
    count: int
    """Number of detections that read it."""


class Reason(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The check that decided, with what it measured and what it asked for."""

    code: ReasonCode
    """The check, as a word for programs."""
    detail: str
    """One sentence for a person."""
    measured: float | None = None
    """The measured value, in the check's own unit."""
    limit: float | None = None
    """The value that it was compared with."""


class Release(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A release."""

    name: str
    """Its name."""
    description: str
    """Free text for people."""
    map_version: int
    """The map's version that it holds."""
    published: Time
    """When it was published."""
    keyframes: int
    """Number of its keyframes."""
    anchors: int
    """Number of its anchors, merged ones counted once."""
    sessions: int
    """Number of its sessions."""
    loops: int
    """Number of its confirmed loops."""
    bytes: int
    """Size of its facts on disk, in bytes: a release takes as much room as the map did."""
    erasures: int
    """How often something was erased from it for good. Else nothing changes it."""
    asked_by: list[ReleaseUse]
    """The robots whose loop queries it answered, the latest first. Written behind: a crash may lose the
    last few.
    """


class ReleaseBody(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A release to be published."""

    description: str | None = None
    """Free text for people."""
    map_version: int | None = None
    """The version that the map must have, if it matters: another one is a conflict."""


class ReleaseChanges(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The changes of a map from a release on. Each list has at most `limit` items; the numbers are of all."""

    since_version: int
    """The version of the release."""
    until_version: int
    """The version that it is compared with."""
    keyframes_added: int
    """Number of keyframes that were added."""
    keyframes_removed: int
    """Number of keyframes that were removed."""
    keyframes_moved: int
    """Number of keyframes that have another pose."""
    anchors_added: int
    """Number of anchors that were added."""
    anchors_removed: int
    """Number of anchors that were removed; one that merged into another was not."""
    anchors_described: int
    """Number of anchors that have another description."""
    anchors_retired: int
    """Number of signs that hang there no longer."""
    anchors_returned: int
    """Number of signs that hang there again."""
    keyframes: list[KeyframeChange]
    """The keyframes concerned."""
    anchors: list[AnchorChange]
    """The anchors concerned; one may be listed for two changes."""


class ReleaseList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Releases of a map, by name."""

    items: list[Release]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class ReleaseUse(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A robot that asked a release."""

    session: str
    """The session of the keyframes that it asked about."""
    queries: int
    """Number of its queries."""
    last: Time
    """When it asked last."""


class Renumbering(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The numbers that the map points of a session get: by `offset` or by `ids`. A point whose new number
    is taken is that point, which keeps its position.
    """

    offset: int | None = None
    """This is added to the number of each."""
    ids: list[list[int]] | None = None
    """`[old, new]` for each that gets another number, no old one twice; the others keep theirs."""


class ReplacedVerdict(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A verdict that was replaced, beside the one that stands now."""

    map_version: int
    """The version of the map that replaced it: earlier answers rest on the verdict before."""
    operation: str
    """The question: `similarity`, `information`, `merge` or `describe`."""
    class_: str = msgspec.field(name="class")
    """The class of the objects."""
    texts: list[str]
    """The texts that were judged, in normal form; none of a crop."""
    before: str
    """The level or the text that was replaced."""
    source_before: str
    """Its source."""
    after: str
    """The level or the text that stands now."""
    source_after: str
    """Its source."""
    keyframe: str | None = None
    """The keyframe of a crop."""
    detection: int | None = None
    """The detection of a crop."""


class SentBagOfWords(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A bag of words: two lists in parallel, in any order. Long lists may be packed."""

    words: list[int] | None = None
    """The words, none twice. This or `words_u32` is required."""
    words_u32: str | None = None
    """The same, packed: base64 of little-endian 32-bit unsigned numbers."""
    weights: list[float] | None = None
    """Their weights, without unit; normalised to sum to one on arrival. This or `weights_f64` is required."""
    weights_f64: str | None = None
    """The same, packed: base64 of little-endian 64-bit floats."""
    vocabulary: str | None = None
    """Whose words these are, such as a vocabulary's fingerprint. Words of two vocabularies do not go into
    one map.
    """


class SentFeatures(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Binary features: three lists in parallel. Long lists may be packed."""

    descriptor_bytes: int
    """Bytes of one descriptor: 32 for ORB, 64 for BRISK."""
    descriptors: str
    """The descriptors one after the other, in base64."""
    keypoints: list[list[float]] | None = None
    """One for each descriptor: `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`, in pixels, pyramid
    level and degrees. Packed, an angle that is not a number is none. This or `keypoints_f32` is
    required.
    """
    keypoints_f32: str | None = None
    """The same, packed: base64 of little-endian 32-bit floats, 4 for each item."""
    map_points: list[int] | None = None
    """The map point that each feature observes, -1 for none; left out if none does."""
    map_points_i64: str | None = None
    """The same, packed: base64 of little-endian 64-bit signed numbers."""


class SentMapPoints(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Positions of map points: two lists in parallel. Long lists may be packed."""

    ids: list[int] | None = None
    """The points' numbers in their session, none twice. This or `ids_i64` is required."""
    ids_i64: str | None = None
    """The same, packed: base64 of little-endian 64-bit signed numbers."""
    positions: list[list[float]] | None = None
    """`[x,y,z]` of each in the session's frame, in metres. This or `positions_f64` is required."""
    positions_f64: str | None = None
    """The same, packed: base64 of little-endian 64-bit floats, 3 for each item."""


class SentSimilarity(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A similarity transformation: scaled, rotated, then moved."""

    translation: Vector3
    """In metres."""
    rotation: Quaternion
    """A unit quaternion."""
    scale: float | None = None
    """Ratio of a length in the outer frame to the same in the inner one; 1 if left out."""


class Session(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A session of a map."""

    session: str
    """Its id."""
    keyframes: int
    """Number of its keyframes."""
    first: Time | None = None
    """The earliest stamp of its keyframes; left out without any."""
    last: Time | None = None
    """The latest stamp of its keyframes; left out without any."""
    priors: int | None = None
    """Number of prior anchors in its frame; left out unless it is the frame of a plan."""
    frame: str | None = None
    """The plan's frame that it is aligned to; left out, as are the next members, while it is not aligned."""
    plan_from_session: Transform | None = None
    """Maps points of the session's frame into the plan's frame."""
    inliers: int | None = None
    """Number of signs of the plan that agree."""
    uncertainty: AlignmentUncertainty | None = None
    """Standard deviations of the alignment, where the signs were seen."""


class SessionList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Sessions, in order of appearance."""

    map_version: int
    """The map's version."""
    items: list[Session]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class SessionsMergedAnswer(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Two sessions are one."""

    map_version: int
    """The map's version after it."""
    keyframes: int
    """Number of keyframes that moved; 0 where the session has none, as after the same request."""
    map_points: int
    """Number of map points with a position that moved."""
    anchors_merged: int
    """Number of anchors that turned out to be one with another."""


class Settings(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Every threshold of the method; the defaults are the paper's, where it has one."""

    method: SettingsMethod | None = None
    """ours: decides on loops: revisit by the odds of all that is known (M64), paper by the paper's letter.
    To set it sets every setting that has a value of its own under the paper; a setting named beside it
    wins
    """
    loop_min_confidence: float | None = None
    """ours: a loop is reported from this confidence on"""
    building_repeats: bool | None = None
    """ours: a place may have a copy elsewhere that nobody has mapped, which shows the same looks, pictures
    and notices: only names and codes tell the two apart. Off, nothing repeats, and looks may close a
    loop
    """
    association_min_point_share: float | None = None
    """§IV-C.1: sigma, the least share of a detection's map points that an anchor's box must cover"""
    covisibility_min_shared_points: int | None = None
    """ORB-SLAM: keyframes of a session that share at least this many map points are covisible"""
    covisibility_max_way_m: float | None = None
    """ours: a keyframe without map points and without `covisible` is covisible with the keyframes of its
    session to which the robot drove no farther, in metres, within 20 s by their clock; 0 joins none
    """
    description_min_information_level: int | None = None
    """§IV-B: an anchor is valid when its description's InformationLevel is no smaller"""
    description_min_crop_area_px: float | None = None
    """§IV-B: a model describes a crop whose box has at least this area, in square pixels; a smaller one
    only once description_refresh_s have passed
    """
    description_refresh_s: float | None = None
    """§IV-B: an anchor not described for this long, by the clock of its keyframes, is described again, in
    seconds
    """
    agreeing_reads: int | None = None
    """ours: a model reads an anchor's crops until this many reads agree; fewer alike are not sure by
    themselves
    """
    matching_min_similarity_level: int | None = None
    """§IV-C.2: two anchors match when their descriptions' SimilarityLevel is no smaller"""
    candidates_max: int | None = None
    """§V, check 2: how many places each channel brings; a place is the best keyframe of a covisible group"""
    candidates_min_gap_s: float | None = None
    """ours: a keyframe of the query's session taken less than this long before or after it, by their
    clock, is no candidate, in seconds; 0 excludes none
    """
    anchor_map_max_angle_difference_rad: float | None = None
    """§V-B: matching anchors differ by less than this in bearing, in radians"""
    anchor_map_max_distance_difference_m: float | None = None
    """§V-B: matching anchors differ by less than this in distance, in metres"""
    anchor_map_min_similarity: float | None = None
    """§V-B: two local anchor maps match when S of Eq. (2) is greater"""
    distinctive_place_radius_m: float | None = None
    """ours: anchors farther apart than this stand in different places, in metres"""
    reading_min_confidence: float | None = None
    """ours: a text of fewer than three specific words that a detection of less confidence read tells
    nothing until another keyframe of the map reads it alike; 0 = off
    """
    identifier_patterns: list[str] | None = None
    """ours: regular expressions of this building's own numbers, at most 16 of 256 bytes; a text that one
    matches whole, whatever its case, is an identifier, and no other text is one; empty: see
    learned_identifiers
    """
    learned_identifiers: bool | None = None
    """ours: learns for each class how the building writes its numbers, from ten values that were read
    alike in two keyframes or more each; from then on no other text of the class is an identifier
    """
    odometry_max_drift_share: float | None = None
    """ours: along an unbroken chain of a session's keyframes odometry is off by at most this share of the
    way; no transformation may contradict it, and two sightings are two places only if it can tell; 0 =
    off
    """
    without_anchors: SettingsWithoutAnchors | None = None
    """§V-B: the verdict when either local anchor map is empty, which the paper leaves open (0/0):
    undecided, reject or geometry
    """
    association_position_radius_m: float | None = None
    """ours: a detection with a position and no map points joins the nearest anchor of its class that a
    covisible keyframe saw, within this distance, in metres; also the distance at which covisible
    anchors that match are merged
    """
    candidates_min_score_ratio: float | None = None
    """ours: a bag-of-words candidate must score at least this share of reference_score; 0 is off"""
    geometry_min_matches: int | None = None
    """ORB-SLAM: the fewest descriptor matches with which a transformation is estimated; with fewer
    geometry is skipped and rejects nothing
    """
    geometry_min_inliers: int | None = None
    """ORB-SLAM: the fewest inliers of a verified transformation, where geometry_acceptance is count"""
    geometry_landmark_sigma_px: float | None = None
    """ours: what the error of a map point's own place adds to that of a keypoint, standard deviation in
    pixels at any octave; 0 = the letter: keypoints alone scatter
    """
    signs_may_change: bool | None = None
    """ours: a sign that three separate passages of a session that has read it had in view and did not see,
    or read otherwise, is retired: it neither agrees nor contradicts, until one passage reads it twice
    as before
    """
    keep_history: bool | None = None
    """storage: keeps what corrections replace, so that export gives what was sent; decides no verdict.
    Off, a corrected map takes less room on disk, and export gives poses and points as last corrected
    """
    revoke_suspects: bool | None = None
    """ours: revokes a confirmed loop as soon as it contradicts the others (GET .../frames): its anchors
    part again. Off, it is listed, and a person decides
    """
    keep_crops: bool | None = None
    """storage: keeps the image crops of detections. Off, a crop goes once it was read, or at once where no
    model of this server reads crops; its text stays
    """
    keep_readings: bool | None = None
    """storage: keeps the record of what models said: their dialogues, and the verdicts and readings that
    later ones replaced. Off, only what is in force stays; decides no verdict
    """
    keep_descriptors_days: int | None = None
    """storage: after so many days a keyframe's features and global descriptor go: it is found by its words
    and anchors then, and geometry is not verified with it; 0 = for ever
    """
    keep_keyframes_days: int | None = None
    """storage: after so many days keyframes are thinned: those go of whose map points others see nine in
    ten, and every anchor (redundant=true), so that no place is forgotten; 0 = for ever
    """
    geometry_models: SettingsGeometryModels | None = None
    """ours: auto verifies by a similarity where enough points are triangulated, else by an essential
    matrix, a homography or a rotation, whichever the two images allow; sim3 is the letter: a similarity
    or nothing
    """
    geometry_acceptance: SettingsGeometryAcceptance | None = None
    """ours: significance accepts inliers that matches placed at random would give less than once in a
    million candidates (log10 of the number of false alarms at most -6; Moisan and Stival 2004); count
    is the letter: geometry_min_inliers, 60 % of which, and an eighth of the matches, have near
    descriptors and points on both sides
    """


class SignToLookFor(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A sign that would tell whether the query was taken at a candidate."""

    keyframe: str
    """The candidate near which it hangs."""
    class_: str = msgspec.field(name="class")
    """Its class."""
    description: str
    """Its description."""
    position: list[float]
    """`[x,y,z]` in the frame of the candidate's session, in metres."""


class Similarity(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A similarity transformation: scale, then rotate, then translate."""

    scale: float
    """Without unit; 1 on metric maps."""
    translation: Vector3
    """In metres."""
    rotation: Quaternion
    """A unit quaternion."""


class Suspect(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A confirmed loop that contradicts the others. Nothing is revoked unasked: `DELETE
    /v1/maps/{map}/loops/{loop}` does it.
    """

    loop: str
    """The loop."""
    cycle: list[str]
    """The loops that lead from the one of its sessions to the other, and do not agree with it; empty where
    it is within one session, whose tracking it contradicts. A plan that is passed has no id.
    """
    residual: float
    """The gap of the cycle, in metres."""
    residual_rad: float
    """Its gap in rotation, in rad."""


class TextPair(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Two descriptions of objects of one class."""

    a: str
    """One description."""
    b: str
    """The other description."""
    class_: str | None = msgspec.field(default=None, name="class")
    """The objects' class."""


class Time(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A moment on the robot's clock, as ROS `builtin_interfaces/Time`."""

    sec: int
    """Whole seconds."""
    nanosec: int
    """Nanoseconds within the second."""


class Transcript(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One dialogue about one crop, and what came of it."""

    keyframe: str
    """The keyframe that brought the crop."""
    detection: int
    """The number of the detection in it."""
    text: str
    """The description; empty if nothing could be made of the crop."""
    source: str
    """The source of the description: `model:<name>`, or a reader of characters such as `tesseract`."""
    degraded: bool
    """Whether a reader stood in because a model was away. It is described again then."""
    steps: list[TranscriptStep]
    """Questions and answers, in their order."""


class TranscriptList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The dialogues about an anchor's crops."""

    map_version: int
    """The map's version."""
    anchor: str
    """The anchor."""
    items: list[Transcript]
    """The dialogues, the newest keyframe's first; at most 32."""


class TranscriptStep(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One question and its answer."""

    speaker: str
    """The source of the answer."""
    question: str
    """The question."""
    answer: str
    """The answer."""


class Transform(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A rigid transformation, as ROS `geometry_msgs/Transform`."""

    translation: Vector3
    """In metres."""
    rotation: Quaternion
    """A unit quaternion."""


class Twins(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Two keyframes of one view, by geometry, around which different signs hang."""

    keyframe: str
    """The keyframe that was written last."""
    candidate: str
    """The keyframe that it was taken for."""
    anchor: str
    """A sign around the first."""
    candidate_anchor: str
    """The sign that hangs in its place around the second."""


class Uncertainty(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The standard deviation of a pose."""

    translation_m: float
    """Of the position, in metres."""
    rotation_rad: float
    """Of the rotation, in radians."""


class UnplacedKeyframe(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A keyframe of an unknown place. Nothing is required; what can be compared is compared. Long lists
    may be packed.
    """

    session: str | None = None
    """Of the robot's own map, as are `observes` and `covisible`: accepted, so that the body of a PUT may
    be asked about as it is, and not listened to.
    """
    observes: list[int] | None = None
    """Not listened to."""
    observes_i64: str | None = None
    """The same, packed: base64 of little-endian 64-bit signed numbers."""
    covisible: list[CovisibleKeyframe] | None = None
    """Not listened to."""
    stamp: Time | None = None
    """When it was taken."""
    pose: Transform | None = None
    """`map_from_camera` in a frame of the robot's own, in metres. Left out: positions are in the camera's
    frame, x right, y down, z forward.
    """
    camera: Camera | None = None
    """The undistorted pinhole camera."""
    gravity: list[float] | None = None
    """The unit vector of gravity in the camera's frame."""
    height_m: float | None = None
    """The height that a barometer tells, in metres. Not listened to."""
    bow: SentBagOfWords | None = None
    """The bag of words."""
    global_descriptor: GlobalDescriptor | None = None
    """A global descriptor of the image."""
    features: SentFeatures | None = None
    """Binary features."""
    map_points: SentMapPoints | None = None
    """Map points of the robot's own, in its own frame."""
    detections: list[Detection] | None = None
    """The objects detected in it."""


class Usage(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Calls of language models since the database was made, by operation and model."""

    calls: int
    """Calls."""
    input_tokens: int
    """Tokens sent."""
    output_tokens: int
    """Tokens received."""
    cost_usd: float
    """Cost in US dollars."""
    cache_hits: int
    """Questions answered from the cache."""
    items: list[UsageItem]
    """The same by operation and model."""
    detail: str
    """One sentence for a person."""
    calls_today: int | None = None
    """Calls since midnight UTC; with models only."""
    cost_usd_today: float | None = None
    """Cost since midnight UTC, in US dollars; with models only."""
    daily_calls: int | None = None
    """The most calls of a day; left out without such a limit."""
    daily_usd: float | None = None
    """The most that a day may cost, in US dollars; left out without such a limit."""
    away: bool | None = None
    """Whether a model is away, or the day's budget spent. With models only."""


class UsageItem(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Calls of one model for one operation."""

    operation: str
    """`similarity`, `information`, `merge`, `describe` or `embed`."""
    model: str
    """The model's name."""
    calls: int
    """Calls."""
    input_tokens: int
    """Tokens sent."""
    output_tokens: int
    """Tokens received."""
    cost_usd: float
    """Cost in US dollars."""
    cache_hits: int
    """Questions answered from the cache."""


class Vector3(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A vector, in metres."""

    x: float
    """Along x, in metres."""
    y: float
    """Along y, in metres."""
    z: float
    """Along z, in metres."""


class VerdictList(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Verdicts, the newest first."""

    items: list[ListedVerdict]
    """The items of this part."""
    next_cursor: str | None
    """The cursor of the next part; null after the last one."""


class Version(msgspec.Struct, kw_only=True, omit_defaults=True):
    """The running program."""

    name: str
    """The program."""
    version: str
    """Its version."""
    sqlite: str
    """The version of SQLite inside it."""
    vocabulary: str | None
    """The vocabulary with which it computes bags of words; null while it has none."""
    postgres: str | None = None
    """The version of the PostgreSQL that keeps its facts; missing where SQLite does."""
