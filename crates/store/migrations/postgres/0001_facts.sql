-- Every fact in plain tables, as SQLite has them: its migration tells what each column holds.
--
-- `map_key` leads the key of every table that grows, so that a sharded PostgreSQL can distribute the tables by it. Texts
-- are compared by their bytes, as SQLite does: orders, and so answers, must not depend on a server's locale.

create table maps (
    map_key bigint not null,
    id text collate "C" not null,
    description text collate "C" not null,
    metric bigint not null,
    anchor_classes text collate "C" not null default '[]',
    code_classes text collate "C" not null default '[]',
    settings text collate "C" not null default '{}',
    version bigint not null,
    -- The dense numbers given next. They are facts: a number is never given twice.
    next_keyframe bigint not null,
    next_anchor bigint not null,
    next_event bigint not null,
    -- The vocabulary its words belong to, by fingerprint, or `client`; null until there are words.
    vocabulary text collate "C",
    -- SHA-256 of the body that made the map, to tell a retry from another map of the same name.
    digest bytea not null,
    owner bigint,
    deleted bigint not null default 0,
    keyframes bigint not null default 0,
    anchors bigint not null default 0,
    sessions bigint not null default 0,
    loops bigint not null default 0,
    bytes bigint not null default 0,
    memory_bytes bigint not null default 0,
    learned text collate "C" not null,
    gravity bytea,
    waits_version bigint,
    waits_part bigint,
    models_away bigint not null default 0,
    constraint maps_key primary key (map_key),
    constraint maps_id unique (id)
);

create table sessions (
    map_key bigint not null,
    session bigint not null,
    id text collate "C" not null,
    constraint sessions_key primary key (map_key, session),
    constraint sessions_id unique (map_key, id),
    constraint sessions_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table keyframes (
    map_key bigint not null,
    keyframe bigint not null,
    id text collate "C" not null,
    session bigint not null,
    stamp_sec bigint not null,
    stamp_nanosec bigint not null,
    -- map_from_camera: tx ty tz qx qy qz qw, as float64.
    pose bytea not null,
    sent_pose bytea not null,
    scale double precision not null,
    -- fx fy cx cy as float64, width height as uint32; null if the client did not tell.
    camera bytea,
    observes bytea not null,
    sent_points bytea not null,
    -- uint32 pairs (keyframe, shared).
    -- Without one the client did not say what is covisible.
    declared bytea,
    bow_words bytea not null,
    bow_weights bytea not null,
    digest bytea not null,
    bytes bigint not null default 0,
    version bigint not null default 0,
    gravity bytea,
    height_m double precision,
    global_model text collate "C",
    global_encoding text collate "C",
    global_descriptor bytea,
    stored_sec bigint not null default 0,
    constraint keyframes_key primary key (map_key, keyframe),
    -- In this order: while tables are new, plans are made without statistics, and a check of a foreign key would take this index by
    -- its prefix, and read the whole map.
    constraint keyframes_id unique (id, map_key),
    constraint keyframes_session foreign key (map_key, session) references sessions (map_key, session) on delete cascade
);

create table keyframe_features (
    map_key bigint not null,
    keyframe bigint not null,
    descriptor_bytes bigint not null,
    descriptors bytea not null,
    keypoints bytea not null,
    map_points bytea not null,
    constraint keyframe_features_key primary key (map_key, keyframe),
    constraint keyframe_features_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade
);

create table anchors (
    map_key bigint not null,
    anchor bigint not null,
    class text collate "C" not null,
    description_by_hand text collate "C",
    version bigint not null,
    constraint anchors_key primary key (map_key, anchor),
    constraint anchors_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table detections (
    map_key bigint not null,
    keyframe bigint not null,
    detection bigint not null,
    class text collate "C" not null,
    confidence double precision not null,
    -- x0 y0 x1 y1 in pixels, as float64.
    box_px bytea not null,
    map_points bytea not null,
    -- x y z in the session's frame, as float64; null if the client sent none.
    position bytea,
    text text collate "C",
    description text collate "C",
    -- `created`, `observed`, or why it feeds no anchor.
    outcome text collate "C" not null,
    anchor bigint,
    range_assumed bigint not null default 0,
    deleted_anchor bigint,
    deleted_in bigint,
    points_now bytea,
    constraint detections_key primary key (map_key, keyframe, detection),
    constraint detections_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade,
    constraint detections_anchor foreign key (map_key, anchor) references anchors (map_key, anchor)
);

create index detections_by_anchor on detections (map_key, anchor) where anchor is not null;

create table crops (
    map_key bigint not null,
    keyframe bigint not null,
    detection bigint not null,
    media_type text collate "C" not null,
    bytes bytea not null,
    constraint crops_key primary key (map_key, keyframe, detection),
    constraint crops_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
);

create table anchor_merges (
    map_key bigint not null,
    into_anchor bigint not null,
    from_anchor bigint not null,
    -- The loop that merged them; empty for a covisible merge.
    loop_id text collate "C" not null,
    constraint anchor_merges_key primary key (map_key, into_anchor, from_anchor, loop_id),
    constraint anchor_merges_into foreign key (map_key, into_anchor)
        references anchors (map_key, anchor) on delete cascade,
    constraint anchor_merges_from foreign key (map_key, from_anchor)
        references anchors (map_key, anchor) on delete cascade
);

create index anchor_merges_by_from on anchor_merges (map_key, from_anchor);

create table loops (
    map_key bigint not null,
    id text collate "C" not null,
    keyframe bigint not null,
    candidate bigint not null,
    -- The names stay when the keyframes are culled.
    keyframe_id text collate "C" not null,
    candidate_id text collate "C" not null,
    query text collate "C",
    candidate_from_query bytea,
    constraint loops_key primary key (map_key, id),
    constraint loops_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table events (
    map_key bigint not null,
    seq bigint not null,
    kind text collate "C" not null,
    map_version bigint not null,
    anchor bigint,
    other bigint,
    keyframe text collate "C",
    candidate text collate "C",
    loop_id text collate "C",
    query text collate "C",
    detail text collate "C",
    session text collate "C",
    into_session text collate "C",
    -- Microseconds since 1970, by the server's clock.
    told_us bigint not null,
    constraint events_key primary key (map_key, seq),
    constraint events_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table loop_queries (
    map_key bigint not null,
    id text collate "C" not null,
    kept bigint not null,
    -- Microseconds since 1970, by the server's clock.
    asked_us bigint not null,
    -- What a list shows of the answer. The keyframe is null where it came with the query.
    keyframe text collate "C",
    candidate text collate "C",
    map_version bigint not null,
    verdict text collate "C" not null,
    reason text collate "C",
    why text collate "C" not null,
    -- The answer, as sent; null once it is too old. Last, so that a list reads no page of it.
    body bytea,
    constraint loop_queries_key primary key (map_key, id),
    constraint loop_queries_map foreign key (map_key) references maps (map_key) on delete cascade
);

create index loop_queries_by_age on loop_queries (map_key, kept);

create table model_readings (
    map_key bigint not null,
    keyframe bigint not null,
    detection bigint not null,
    text text collate "C" not null,
    -- `model:<name>`, or the reader's name.
    source text collate "C" not null,
    -- Did a model describe it, rather than a reader of characters?
    described bigint not null,
    -- Did a reader stand in because the model was away? It is read again then.
    degraded bigint not null,
    fingerprint text collate "C" not null default '',
    version bigint not null default 0,
    dialogue text collate "C",
    constraint model_readings_key primary key (map_key, keyframe, detection),
    constraint model_readings_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
);

create table model_verdicts (
    map_key bigint not null,
    operation text collate "C" not null,
    class text collate "C" not null,
    a text collate "C" not null,
    b text collate "C" not null,
    -- 1 to 5; null for a merged text.
    level bigint,
    -- The merged text; null for a level.
    text text collate "C",
    source text collate "C" not null,
    reason text collate "C" not null default '',
    fingerprint text collate "C" not null default '',
    version bigint not null default 0,
    constraint model_verdicts_key primary key (map_key, operation, class, a, b),
    constraint model_verdicts_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table model_answers (
    -- Grows with each answer, so that the oldest can go.
    kept bigint generated by default as identity,
    key bytea not null,
    operation text collate "C" not null,
    model text collate "C" not null,
    answer text collate "C" not null,
    constraint model_answers_key primary key (kept),
    constraint model_answers_question unique (key)
);

create table model_usage (
    day bigint not null,
    operation text collate "C" not null,
    model text collate "C" not null,
    calls bigint not null,
    input_tokens bigint not null,
    output_tokens bigint not null,
    cost_microusd bigint not null,
    cache_hits bigint not null,
    constraint model_usage_key primary key (day, operation, model)
);

create table keys (
    key bigint not null,
    name text collate "C" not null,
    -- SHA-256 of the secret, which is shown once and kept nowhere. It has 256 random bits: no salt and no slow hash is needed.
    hash bytea not null,
    -- Bits: 1 read, 2 write, 4 query, 8 admin.
    actions bigint not null,
    created_sec bigint not null,
    expires_sec bigint,
    expires_nanosec bigint,
    revoked_sec bigint,
    -- Requests a second.
    rate_per_s bigint,
    -- Maps that this key made and that exist, and their bytes with those of their releases.
    max_maps bigint,
    max_bytes bigint,
    -- What a day (UTC) of models may bring for the maps that this key made and the texts it asks about.
    model_daily_calls bigint,
    model_daily_microusd bigint,
    maps text collate "C" not null,
    constraint keys_key primary key (key),
    constraint keys_hash unique (hash)
);

create table counters (
    name text collate "C" not null,
    last bigint not null,
    constraint counters_key primary key (name)
);

insert into counters (name, last) values ('event', 0), ('key', 0), ('map', 0);

create table key_usage (
    day bigint not null,
    key bigint not null,
    calls bigint not null,
    cost_microusd bigint not null,
    constraint key_usage_key primary key (day, key)
);

create index maps_deleted on maps (map_key) where deleted = 1;

create table judgements (
    map_key bigint not null,
    id text collate "C" not null,
    -- Jobs of a map are counted, so that the oldest can go.
    number bigint not null,
    -- `all`, `texts` or `crops`.
    asks text collate "C" not null,
    -- `running`, `done` or `stopped`.
    state text collate "C" not null,
    -- The map's version when it began.
    since_version bigint not null,
    -- As foreseen when it began.
    questions bigint not null,
    calls_max bigint not null,
    cost_max_microusd bigint not null,
    -- What has become of the questions so far.
    changed bigint not null,
    unchanged bigint not null,
    gone bigint not null,
    failed bigint not null,
    -- The question that was settled last: of a crop its keyframe and detection, of texts what was asked about which.
    -- Crops come first. All null before the first question is settled; of each kind only its own columns are set.
    at_operation text collate "C",
    at_keyframe bigint,
    at_detection bigint,
    at_class text collate "C",
    at_a text collate "C",
    at_b text collate "C",
    constraint judgements_key primary key (map_key, id),
    constraint judgements_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table twins (
    map_key bigint not null,
    -- The keyframe that was written last, and the one that it was taken for.
    keyframe bigint not null,
    candidate bigint not null,
    -- The signs that exclude each other.
    anchor bigint not null,
    candidate_anchor bigint not null,
    constraint twins_key primary key (map_key, keyframe, candidate, anchor, candidate_anchor),
    constraint twins_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table missed_signs (
    map_key bigint not null,
    anchor bigint not null,
    -- The last keyframe of the passage that had the sign in view.
    keyframe bigint not null,
    -- The sign that hangs in its place; null where there is none.
    other bigint,
    constraint missed_signs_key primary key (map_key, anchor, keyframe),
    constraint missed_signs_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
);

create table retired_signs (
    map_key bigint not null,
    anchor bigint not null,
    -- The sign that hangs in its place; null where there is none, or where it is gone, too.
    replaced_by bigint,
    constraint retired_signs_key primary key (map_key, anchor),
    constraint retired_signs_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
);

create index detections_by_deleted_anchor on detections (map_key, deleted_anchor) where deleted_anchor is not null;

create index detections_by_deletion on detections (map_key, deleted_in) where deleted_in is not null;

create table versions (
    map_key bigint not null,
    version bigint not null,
    part bigint not null,
    -- `said`, `moved`, `passing` or `unsaid`.
    kind text collate "C" not null,
    body bytea not null,
    constraint versions_key primary key (map_key, version, part),
    constraint versions_map foreign key (map_key) references maps (map_key) on delete cascade
);

create index versions_unsaid on versions (map_key, version) where part < 0;

create index maps_waiting on maps (map_key) where waits_version is not null;

create table point_blocks (
    map_key bigint not null,
    session bigint not null,
    -- The points' numbers divided by 64.
    block bigint not null,
    -- A uint64 whose bits say which of the 64 are there, then float64 x y z of each in turn.
    points bytea not null,
    constraint point_blocks_key primary key (map_key, session, block),
    constraint point_blocks_session foreign key (map_key, session) references sessions (map_key, session) on delete cascade
);

create table prior_anchors (
    map_key bigint not null,
    anchor bigint not null,
    -- Chosen by the client.
    id text collate "C" not null,
    -- The session that stands for the plan's frame.
    frame bigint not null,
    description text collate "C" not null,
    -- Three packed f64 in the plan's frame, in metres.
    position bytea not null,
    -- Three packed f64: the unit vector out of the wall; null where the plan does not say.
    normal bytea,
    source text collate "C",
    constraint prior_anchors_key primary key (map_key, anchor),
    constraint prior_anchors_id unique (map_key, id),
    constraint prior_anchors_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
);

create table keyframe_points (
    map_key bigint not null,
    keyframe bigint not null,
    -- Columns of integers: the points observed, ascending; those that features were sent with and that are others now, ascending;
    -- and what these are now.
    observes bytea not null,
    renamed_from bytea not null,
    renamed_to bytea not null,
    -- uint32 pairs (keyframe, shared).
    -- Without one the client did not say what is covisible.
    declared bytea,
    -- What the keyframe takes, as keyframes.bytes counts it.
    bytes bigint not null,
    renames_all bigint not null default 0,
    constraint keyframe_points_key primary key (map_key, keyframe),
    constraint keyframe_points_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade
);

create table session_merges (
    map_key bigint not null,
    version bigint not null,
    -- The session that went, and the one that its keyframes are of from then on.
    session bigint not null,
    into_session bigint not null,
    -- The number that the next keyframe had: it, and those after it, are not concerned.
    next_keyframe bigint not null,
    -- What revokes the merge beside the values that the log says it replaced, as JSON; null once something was written on top of it.
    undo text collate "C",
    constraint session_merges_key primary key (map_key, version),
    constraint session_merges_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table fleet_frames (
    map_key bigint not null,
    -- The map's version that it was computed at.
    version bigint not null,
    body text collate "C" not null,
    constraint fleet_frames_key primary key (map_key),
    constraint fleet_frames_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table releases (
    map_key bigint not null,
    name text collate "C" not null,
    release_key bigint not null,
    -- The map's version that it holds. That of its own map is higher once something was erased from it.
    map_version bigint not null,
    -- How often something was erased from it for good.
    erasures bigint not null default 0,
    description text collate "C" not null,
    published_sec bigint not null,
    published_nanosec bigint not null,
    -- SHA-256 of the request, to tell a retry from another release of the same name.
    digest bytea not null,
    constraint releases_key primary key (map_key, name),
    constraint releases_rows unique (release_key),
    constraint releases_map foreign key (map_key) references maps (map_key) on delete cascade,
    constraint releases_held_by foreign key (release_key) references maps (map_key) on delete cascade
);

create table release_uses (
    map_key bigint not null,
    session text collate "C" not null,
    queries bigint not null,
    last_sec bigint not null,
    last_nanosec bigint not null,
    constraint release_uses_key primary key (map_key, session),
    constraint release_uses_map foreign key (map_key) references maps (map_key) on delete cascade
);

create table erasures (
    map_key bigint not null,
    number bigint not null,
    -- `removing`, `rewriting` or `done`.
    state text collate "C" not null,
    -- What is to be erased, as JSON; null once it is removed, for it names what must not stay.
    asked text collate "C",
    keyframes bigint not null,
    releases bigint not null,
    begun_sec bigint not null,
    begun_nanosec bigint not null,
    ended_sec bigint,
    ended_nanosec bigint,
    constraint erasures_key primary key (map_key, number),
    constraint erasures_map foreign key (map_key) references maps (map_key) on delete cascade
);

-- The oldest version of the schema that a program may know to work with this one.
create table schema_reach (
    only_row bigint not null,
    oldest bigint not null,
    constraint schema_reach_key primary key (only_row)
);

-- The servers that share this database, each by an id that it makes up when it starts.
create table nodes (
    node text collate "C" not null,
    -- Where the others reach it, and the secret by which it knows their requests.
    address text collate "C" not null,
    secret text collate "C" not null,
    -- The newest version of the schema that its program knows.
    schema bigint not null,
    -- By this database's clock, as all times of leases are.
    expires timestamptz not null,
    constraint nodes_key primary key (node)
);

-- Which server has a map in memory and may write to it. Nothing but the primary key is unique here: a server that extends its
-- leases must not wait for its own writes, which lock the key.
create table map_owners (
    map_key bigint not null,
    -- Null once it was given back.
    owner text collate "C",
    -- Grows with each taking. A write of an older one is refused.
    epoch bigint not null,
    expires timestamptz not null,
    constraint map_owners_key primary key (map_key),
    constraint map_owners_map foreign key (map_key) references maps (map_key) on delete cascade
);

-- What the newest versions of a map changed, for the servers that follow it: written while one does, and kept for a minute.
create table map_changes (
    map_key bigint not null,
    version bigint not null,
    -- The form of the changes. A server that does not know it loads the map anew.
    format text collate "C" not null,
    changes bytea not null,
    written timestamptz not null default clock_timestamp(),
    constraint map_changes_key primary key (map_key, version),
    constraint map_changes_map foreign key (map_key) references maps (map_key) on delete cascade
);

create index map_changes_by_age on map_changes (written);

-- How often rows of a map were changed that no version tells: whoever follows it loads it anew.
create table map_rewrites (
    map_key bigint not null,
    rewritten bigint not null,
    constraint map_rewrites_key primary key (map_key),
    constraint map_rewrites_map foreign key (map_key) references maps (map_key) on delete cascade
);

-- Which servers follow a map that another one owns.
create table map_followers (
    map_key bigint not null,
    node text collate "C" not null,
    expires timestamptz not null,
    constraint map_followers_key primary key (map_key, node),
    constraint map_followers_map foreign key (map_key) references maps (map_key) on delete cascade
);

-- Answers of loop queries that a server gave that follows the map, on their way to its owner.
create table followed_queries (
    map_key bigint not null,
    id text collate "C" not null,
    keyframe text collate "C",
    candidate text collate "C",
    map_version bigint not null,
    verdict text collate "C" not null,
    reason text collate "C",
    why text collate "C" not null,
    body bytea not null,
    constraint followed_queries_key primary key (map_key, id),
    constraint followed_queries_map foreign key (map_key) references maps (map_key) on delete cascade
);

-- What a day's calls of models may cost at most, by who pays: 0 is the server, else a key. Reserved before each call.
create table model_days (
    day bigint not null,
    payer bigint not null,
    calls bigint not null,
    cost_microusd bigint not null,
    constraint model_days_key primary key (day, payer)
);

-- How many requests a second each server admits of a key whose rate is limited.
create table key_rates (
    key bigint not null,
    node text collate "C" not null,
    requests bigint not null,
    expires timestamptz not null,
    constraint key_rates_key primary key (key, node)
);

-- Packed lists and images do not get smaller: trying costs more than their transport.
alter table keyframes
    alter column observes set storage external,
    alter column bow_words set storage external,
    alter column bow_weights set storage external,
    alter column global_descriptor set storage external;
alter table keyframe_features
    alter column descriptors set storage external,
    alter column keypoints set storage external,
    alter column map_points set storage external;
alter table crops alter column bytes set storage external;
alter table point_blocks alter column points set storage external;

insert into schema_reach (only_row, oldest) values (1, 1);
-- What SQLite has and PostgreSQL calls otherwise, so that statements need not be written twice.

create function json_each(list text) returns table (value text) language sql immutable strict
    as $$ select jsonb_array_elements_text(list::jsonb) $$;
