-- The facts of every map. What can be derived (covisibility, descriptions, boxes, matches,
-- postings) is not stored: it is built in memory when a map is first asked for.
-- `map_key` leads every key, so that a map's rows lie together and go together.
-- Lengths are metres, in the frame of the keyframe's session. Blobs are packed little-endian lists,
-- or, where a comment says *column*, as `store/columns/column.rs` packs them.

create table maps (
    map_key integer not null,
    id text not null,
    description text not null,
    metric integer not null,
    -- JSON: lists of the classes of which anchors are made, and of those whose texts are compared exactly; and the settings that
    -- differ from their defaults, so that a better default reaches maps that never chose.
    anchor_classes text not null default '[]',
    code_classes text not null default '[]',
    settings text not null default '{}',
    version integer not null,
    -- The dense numbers given next. They are facts: a number is never given twice.
    next_keyframe integer not null,
    next_anchor integer not null,
    next_event integer not null,
    -- The vocabulary its words belong to, by fingerprint, or `client`; null until there are words.
    vocabulary text,
    -- SHA-256 of the body that made the map, to tell a retry from another map of the same name.
    digest blob not null,
    -- The key that made the map, which pays for its models; null if it was made without one.
    owner integer,
    -- 1 if the map is deleted: its rows are removed in slices, and then this one; 2 while it is a copy that is not complete. Its id
    -- is then one that no client can give.
    deleted integer not null default 0,
    -- The figures that a list of maps shows, kept beside the map's version: each commit writes them with it, so that
    -- a list reads no map. They follow from the facts; `revisit check` holds the two against each other.
    keyframes integer not null default 0,
    -- Merged ones counted once.
    anchors integer not null default 0,
    sessions integer not null default 0,
    loops integer not null default 0,
    -- What the map's facts take on disk.
    bytes integer not null default 0,
    -- What its index takes in memory, as last estimated: how much room is made before it is loaded. A hint, never checked.
    memory_bytes integer not null default 0,
    -- What a map has learned of its building, as JSON: written with its figures.
    learned text not null,
    -- float64 x y z: the unit vector of gravity in the frame of the map's sessions; null where it is not known.
    gravity blob,
    -- The part of the log from which on poses and points wait for their rows; null where none do.
    waits_version integer,
    waits_part integer,
    -- Whether questions wait because the model is away: a verdict about the map says so.
    models_away integer not null default 0,
    constraint maps_key primary key (map_key),
    constraint maps_id unique (id)
) strict;

create table sessions (
    map_key integer not null,
    session integer not null,
    id text not null,
    constraint sessions_key primary key (map_key, session),
    constraint sessions_id unique (map_key, id),
    constraint sessions_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

create table keyframes (
    map_key integer not null,
    keyframe integer not null,
    id text not null,
    session integer not null,
    stamp_sec integer not null,
    stamp_nanosec integer not null,
    -- map_from_camera: tx ty tz qx qy qz qw, as float64.
    pose blob not null,
    -- As it was sent: the positions of its detections are of that time. By now lengths are `scale` times as long.
    sent_pose blob not null,
    scale real not null,
    -- fx fy cx cy as float64, width height as uint32; null if the client did not tell.
    camera blob,
    -- Columns of point numbers, ascending: all points observed, and those sent with a position.
    observes blob not null,
    sent_points blob not null,
    -- uint32 pairs (keyframe, shared).
    -- Without one the client did not say what is covisible.
    declared blob,
    -- Columns of words, ascending, and of weights in units of 2^-31.
    bow_words blob not null,
    bow_weights blob not null,
    -- BLAKE3 of its facts, to tell a retry from another keyframe of the same name.
    digest blob not null,
    -- What a keyframe takes on disk, as far as its client's body says: words, points, features, crops.
    bytes integer not null default 0,
    -- The version of the map that it made.
    version integer not null default 0,
    -- float64 x y z: the unit vector of gravity in the camera frame; null where it is not known.
    gravity blob,
    -- The height that a barometer tells, in metres above a level of the session's own; null where it is not known.
    height_m real,
    -- The vector of the whole image: the model that computed it, 'int8' or 'bits', and its numbers; null where none was sent.
    global_model text,
    global_encoding text,
    global_descriptor blob,
    -- When it was stored, by the server's clock.
    stored_sec integer not null default 0,
    constraint keyframes_key primary key (map_key, keyframe),
    constraint keyframes_id unique (map_key, id),
    constraint keyframes_session foreign key (map_key, session) references sessions (map_key, session) on delete cascade
) strict;

-- Apart from `keyframes`: large, and read only for the few candidates that geometry verifies.
create table keyframe_features (
    map_key integer not null,
    keyframe integer not null,
    descriptor_bytes integer not null,
    descriptors blob not null,
    -- Columns of u, v and angle_deg (NaN without one), and uint8 octaves, each preceded by its length.
    keypoints blob not null,
    -- A column with a number for each feature; -1 without one.
    map_points blob not null,
    constraint keyframe_features_key primary key (map_key, keyframe),
    constraint keyframe_features_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade
) strict;

create table anchors (
    map_key integer not null,
    anchor integer not null,
    class text not null,
    description_by_hand text,
    version integer not null,
    constraint anchors_key primary key (map_key, anchor),
    constraint anchors_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

create table detections (
    map_key integer not null,
    keyframe integer not null,
    detection integer not null,
    class text not null,
    confidence real not null,
    -- x0 y0 x1 y1 in pixels, as float64.
    box_px blob not null,
    map_points blob not null,
    -- x y z in the session's frame, as float64, as it was sent with the keyframe; null if the client sent none.
    position blob,
    text text,
    description text,
    -- `created`, `observed`, or why it feeds no anchor.
    outcome text not null,
    anchor integer,
    -- Whether nothing measured how far the object is, so that its position is right in its bearing alone.
    range_assumed integer not null default 0 check (range_assumed in (0, 1)),
    -- The anchor that the detection fed until it was deleted, and the version that deleted it; null where nobody
    -- did.
    deleted_anchor integer,
    deleted_in integer,
    -- A column of integers, ascending: its map points where they are others now than were sent.
    points_now blob,
    constraint detections_key primary key (map_key, keyframe, detection),
    constraint detections_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade,
    constraint detections_anchor foreign key (map_key, anchor) references anchors (map_key, anchor)
) strict;

create index detections_by_anchor on detections (map_key, anchor) where anchor is not null;

create table crops (
    map_key integer not null,
    keyframe integer not null,
    detection integer not null,
    media_type text not null,
    bytes blob not null,
    constraint crops_key primary key (map_key, keyframe, detection),
    constraint crops_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
) strict;

create table anchor_merges (
    map_key integer not null,
    into_anchor integer not null,
    from_anchor integer not null,
    -- The loop that merged them; empty for a covisible merge.
    loop_id text not null,
    constraint anchor_merges_key primary key (map_key, into_anchor, from_anchor, loop_id),
    constraint anchor_merges_into foreign key (map_key, into_anchor)
        references anchors (map_key, anchor) on delete cascade,
    constraint anchor_merges_from foreign key (map_key, from_anchor)
        references anchors (map_key, anchor) on delete cascade
) strict, without rowid;

create index anchor_merges_by_from on anchor_merges (map_key, from_anchor);

create table loops (
    map_key integer not null,
    id text not null,
    keyframe integer not null,
    candidate integer not null,
    -- The names stay when the keyframes are culled.
    keyframe_id text not null,
    candidate_id text not null,
    query text,
    -- candidate_from_query of the query that found the loop, as eight float64: scale, translation, quaternion; null if it is not known.
    candidate_from_query blob,
    constraint loops_key primary key (map_key, id),
    constraint loops_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

create table events (
    map_key integer not null,
    seq integer not null,
    kind text not null,
    map_version integer not null,
    anchor integer,
    other integer,
    keyframe text,
    candidate text,
    loop_id text,
    query text,
    detail text,
    session text,
    into_session text,
    -- Microseconds since 1970, by the server's clock.
    told_us integer not null,
    constraint events_key primary key (map_key, seq),
    constraint events_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

create table loop_queries (
    map_key integer not null,
    id text not null,
    kept integer not null,
    -- Microseconds since 1970, by the server's clock.
    asked_us integer not null,
    -- What a list shows of the answer. The keyframe is null where it came with the query.
    keyframe text,
    candidate text,
    map_version integer not null,
    verdict text not null,
    reason text,
    why text not null,
    -- The answer, as sent; null once it is too old. Last, so that a list reads no page of it.
    body blob,
    constraint loop_queries_key primary key (map_key, id),
    constraint loop_queries_map foreign key (map_key) references maps (map_key) on delete cascade
) strict;

create index loop_queries_by_age on loop_queries (map_key, kept);

-- What language and vision models said. Their verdicts are facts: a map's index is built from them,
-- so that a loop query asks nobody. What was paid for is kept as well, so that nothing is paid twice.

-- What a model, or a reader of characters, made of a detection's crop. Empty text: it made nothing of it.
create table model_readings (
    map_key integer not null,
    keyframe integer not null,
    detection integer not null,
    text text not null,
    -- `model:<name>`, or the reader's name.
    source text not null,
    -- Did a model describe it, rather than a reader of characters?
    described integer not null,
    -- Did a reader stand in because the model was away? It is read again then.
    degraded integer not null,
    fingerprint text not null default '',
    version integer not null default 0,
    -- The dialogue that led to it, step by step, as JSON; null where none is kept.
    dialogue text,
    constraint model_readings_key primary key (map_key, keyframe, detection),
    constraint model_readings_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
) strict;

-- SimilarityLevel, InformationLevel and MergeText of texts of one class, in normal form.
-- Of a pair the smaller text is `a`; of a single text `b` is empty.
create table model_verdicts (
    map_key integer not null,
    operation text not null,
    class text not null,
    a text not null,
    b text not null,
    -- 1 to 5; null for a merged text.
    level integer,
    -- The merged text; null for a level.
    text text,
    source text not null,
    -- Why, in one sentence by the model; empty where it was not told.
    reason text not null default '',
    -- The hash of the models and prompts behind the row; empty where it was not kept.
    fingerprint text not null default '',
    version integer not null default 0,
    constraint model_verdicts_key primary key (map_key, operation, class, a, b),
    constraint model_verdicts_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Every answer that was paid for, by the hash of all that it depends on.
create table model_answers (
    kept integer not null,
    key blob not null,
    operation text not null,
    model text not null,
    answer text not null,
    constraint model_answers_key primary key (kept),
    constraint model_answers_question unique (key)
) strict;

-- Calls and what they cost, by day since 1970 (UTC). What a call may cost is written before it is made.
create table model_usage (
    day integer not null,
    operation text not null,
    model text not null,
    calls integer not null,
    input_tokens integer not null,
    output_tokens integer not null,
    cost_microusd integer not null,
    cache_hits integer not null,
    constraint model_usage_key primary key (day, operation, model)
) strict, without rowid;

-- Who may do what, who pays for models, and how much a map holds.

-- A key is never deleted, only revoked: a database that ever had keys does not open itself to everybody again.
create table keys (
    key integer not null,
    name text not null,
    -- SHA-256 of the secret, which is shown once and kept nowhere. It has 256 random bits: no salt and no slow hash is needed.
    hash blob not null,
    -- Bits: 1 read, 2 write, 4 query, 8 admin.
    actions integer not null,
    created_sec integer not null,
    expires_sec integer,
    expires_nanosec integer,
    revoked_sec integer,
    -- Requests a second.
    rate_per_s integer,
    -- Maps that this key made and that exist, and their bytes with those of their releases.
    max_maps integer,
    max_bytes integer,
    -- What a day (UTC) of models may bring for the maps that this key made and the texts it asks about.
    model_daily_calls integer,
    model_daily_microusd integer,
    -- Patterns of the maps that it may use, as a JSON list.
    maps text not null,
    constraint keys_key primary key (key),
    constraint keys_hash unique (hash)
) strict;

-- `map`: the key that was given last to a map; it is never given twice, for what a process still holds of a deleted map must not be
-- taken for another map's. `event`: the greatest number that the next event of a deleted map would have had; events of new maps are
-- numbered from above it. `key`: counted up with every key made or revoked, by which a server sees what another process did.
create table counters (
    name text not null,
    last integer not null,
    constraint counters_key primary key (name)
) strict, without rowid;

insert into counters (name, last) values ('event', 0), ('key', 0), ('map', 0);

-- What a day of models brought for a key. What a call may cost is written before it is made.
create table key_usage (
    day integer not null,
    key integer not null,
    calls integer not null,
    cost_microusd integer not null,
    constraint key_usage_key primary key (day, key)
) strict, without rowid;

create index maps_deleted on maps (map_key) where deleted = 1;

-- The jobs that ask again, each with the question that it has come to.
create table judgements (
    map_key integer not null,
    id text not null,
    -- Jobs of a map are counted, so that the oldest can go.
    number integer not null,
    -- `all`, `texts` or `crops`.
    asks text not null,
    -- `running`, `done` or `stopped`.
    state text not null,
    -- The map's version when it began.
    since_version integer not null,
    -- As foreseen when it began.
    questions integer not null,
    calls_max integer not null,
    cost_max_microusd integer not null,
    -- What has become of the questions so far.
    changed integer not null,
    unchanged integer not null,
    gone integer not null,
    failed integer not null,
    -- The question that was settled last: of a crop its keyframe and detection, of texts what was asked about which.
    -- Crops come first. All null before the first question is settled; of each kind only its own columns are set.
    at_operation text,
    at_keyframe integer,
    at_detection integer,
    at_class text,
    at_a text,
    at_b text,
    constraint judgements_key primary key (map_key, id),
    constraint judgements_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Pairs of keyframes of one view, by geometry, around which different signs hang. A row whose keyframes or anchors are gone,
-- or whose signs no longer differ, counts for nothing and gives way to the next pair that is found.
create table twins (
    map_key integer not null,
    -- The keyframe that was written last, and the one that it was taken for.
    keyframe integer not null,
    candidate integer not null,
    -- The signs that exclude each other.
    anchor integer not null,
    candidate_anchor integer not null,
    constraint twins_key primary key (map_key, keyframe, candidate, anchor, candidate_anchor),
    constraint twins_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Passages that had a sign in view and did not see it as it is called. They go with their sign; that its keyframe is culled
-- does not undo a passage.
create table missed_signs (
    map_key integer not null,
    anchor integer not null,
    -- The last keyframe of the passage that had the sign in view.
    keyframe integer not null,
    -- The sign that hangs in its place; null where there is none.
    other integer,
    constraint missed_signs_key primary key (map_key, anchor, keyframe),
    constraint missed_signs_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
) strict, without rowid;

-- Signs that hang there no longer.
create table retired_signs (
    map_key integer not null,
    anchor integer not null,
    -- The sign that hangs in its place; null where there is none, or where it is gone, too.
    replaced_by integer,
    constraint retired_signs_key primary key (map_key, anchor),
    constraint retired_signs_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
) strict, without rowid;

create index detections_by_deleted_anchor on detections (map_key, deleted_anchor) where deleted_anchor is not null;

create index detections_by_deletion on detections (map_key, deleted_in) where deleted_in is not null;

-- The log: what versions of a map said and replaced that its rows do not tell. `export` reads it beside the rows.
create table versions (
    map_key integer not null,
    version integer not null,
    -- 0 says what the version said, and makes it count. Those above hold poses and points of a large correction; they are written
    -- first, and wait for their rows. -1 is what models said before this version.
    part integer not null,
    -- `said`; `moved`: poses and points, or values that were replaced; `passing`: goes once it is in the rows; `unsaid`.
    kind text not null,
    -- MessagePack, as `store/log/entry.rs` has it.
    body blob not null,
    constraint versions_key primary key (map_key, version, part),
    constraint versions_map foreign key (map_key) references maps (map_key) on delete cascade
) strict;

create index versions_unsaid on versions (map_key, version) where part < 0;

create index maps_waiting on maps (map_key) where waits_version is not null;

-- Map points, 64 numbers to a row: a row of its own would take twice the bytes of a position.
create table point_blocks (
    map_key integer not null,
    session integer not null,
    -- The points' numbers divided by 64.
    block integer not null,
    -- A uint64 whose bits say which of the 64 are there, then float64 x y z of each in turn.
    points blob not null,
    constraint point_blocks_key primary key (map_key, session, block),
    constraint point_blocks_session foreign key (map_key, session) references sessions (map_key, session) on delete cascade
) strict, without rowid;

-- Anchors that a plan shows, known before any robot saw them. The row in anchors has their class and version.
create table prior_anchors (
    map_key integer not null,
    anchor integer not null,
    -- Chosen by the client.
    id text not null,
    -- The session that stands for the plan's frame.
    frame integer not null,
    description text not null,
    -- Three packed f64 in the plan's frame, in metres.
    position blob not null,
    -- Three packed f64: the unit vector out of the wall; null where the plan does not say.
    normal blob,
    source text,
    constraint prior_anchors_key primary key (map_key, anchor),
    constraint prior_anchors_id unique (map_key, id),
    constraint prior_anchors_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
) strict, without rowid;

-- What a client's map did to the points and edges of keyframes after it had sent them. The rows in keyframes and detections
-- keep what was sent.

create table keyframe_points (
    map_key integer not null,
    keyframe integer not null,
    -- Columns of integers: the points observed, ascending; those that features were sent with and that are others now, ascending;
    -- and what these are now.
    observes blob not null,
    renamed_from blob not null,
    renamed_to blob not null,
    -- uint32 pairs (keyframe, shared).
    -- Without one the client did not say what is covisible.
    declared blob,
    -- What the keyframe takes, as keyframes.bytes counts it.
    bytes integer not null,
    -- Whether a feature sent with a point that renamed_from does not list observes none.
    renames_all integer not null default 0,
    constraint keyframe_points_key primary key (map_key, keyframe),
    constraint keyframe_points_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade
) strict, without rowid;

-- Sessions that became one with another. The rows in keyframes keep the session that was sent.

create table session_merges (
    map_key integer not null,
    version integer not null,
    -- The session that went, and the one that its keyframes are of from then on.
    session integer not null,
    into_session integer not null,
    -- The number that the next keyframe had: it, and those after it, are not concerned.
    next_keyframe integer not null,
    -- What revokes the merge beside the values that the log says it replaced, as JSON; null once something was written on top of it.
    undo text,
    constraint session_merges_key primary key (map_key, version),
    constraint session_merges_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Where the sessions lie to each other, computed once by the server that owns the map, and read by all.
create table fleet_frames (
    map_key integer not null,
    -- The map's version that it was computed at.
    version integer not null,
    body text not null,
    constraint fleet_frames_key primary key (map_key),
    constraint fleet_frames_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Releases: named versions of a map. The rows of each are those of a map of its own, to which nobody writes and whose id is
-- `map/release`, which no client can give.
create table releases (
    map_key integer not null,
    name text not null,
    release_key integer not null,
    -- The map's version that it holds. That of its own map is higher once something was erased from it.
    map_version integer not null,
    -- How often something was erased from it for good.
    erasures integer not null default 0,
    description text not null,
    published_sec integer not null,
    published_nanosec integer not null,
    -- SHA-256 of the request, to tell a retry from another release of the same name.
    digest blob not null,
    constraint releases_key primary key (map_key, name),
    constraint releases_rows unique (release_key),
    constraint releases_map foreign key (map_key) references maps (map_key) on delete cascade,
    constraint releases_held_by foreign key (release_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Who asked a release. Here `map_key` is that of the map that holds its rows.
create table release_uses (
    map_key integer not null,
    session text not null,
    queries integer not null,
    last_sec integer not null,
    last_nanosec integer not null,
    constraint release_uses_key primary key (map_key, session),
    constraint release_uses_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- What leaves a map, its releases and the disk for good.
create table erasures (
    map_key integer not null,
    number integer not null,
    -- `removing`, `rewriting` or `done`.
    state text not null,
    -- What is to be erased, as JSON; null once it is removed, for it names what must not stay.
    asked text,
    keyframes integer not null,
    releases integer not null,
    begun_sec integer not null,
    begun_nanosec integer not null,
    ended_sec integer,
    ended_nanosec integer,
    constraint erasures_key primary key (map_key, number),
    constraint erasures_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

