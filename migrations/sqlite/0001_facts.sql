-- The facts of every map. What can be derived (covisibility, descriptions, boxes, matches,
-- postings) is not stored: it is built in memory when a map is first asked for.
-- `map_key` leads every key, so that a map's rows lie together and go together.
-- Lengths are metres, in the frame of the keyframe's session. Blobs are packed little-endian lists.

create table maps (
    map_key integer not null,
    id text not null,
    description text not null,
    metric integer not null,
    version integer not null,
    -- The dense numbers given next. They are facts: a number is never given twice.
    next_keyframe integer not null,
    next_anchor integer not null,
    next_event integer not null,
    -- The vocabulary its words belong to, by fingerprint, or `client`; null until there are words.
    vocabulary text,
    -- SHA-256 of the body that made the map, to tell a retry from another map of the same name.
    digest blob not null,
    constraint maps_key primary key (map_key),
    constraint maps_id unique (id)
) strict;

create table map_anchor_classes (
    map_key integer not null,
    class text not null,
    constraint map_anchor_classes_key primary key (map_key, class),
    constraint map_anchor_classes_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Only what differs from the default, so that a better default reaches maps that never chose.
create table map_settings (
    map_key integer not null,
    name text not null,
    value text not null,
    constraint map_settings_key primary key (map_key, name),
    constraint map_settings_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

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
    -- fx fy cx cy as float64, width height as uint32; null if the client did not tell.
    camera blob,
    -- int64 point numbers, ascending: all points observed, and those sent with a position.
    observes blob not null,
    sent_points blob not null,
    -- uint32 pairs (keyframe, shared).
    declared blob not null,
    -- uint32 words, ascending, and uint32 weights in units of 2^-31.
    bow_words blob not null,
    bow_weights blob not null,
    digest blob not null,
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
    -- float64 u v angle_deg (NaN without one) and uint8 octave, for each feature.
    keypoints blob not null,
    -- int64 for each feature; -1 without one.
    map_points blob not null,
    constraint keyframe_features_key primary key (map_key, keyframe),
    constraint keyframe_features_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade
) strict;

create table map_points (
    map_key integer not null,
    session integer not null,
    point integer not null,
    x real not null,
    y real not null,
    z real not null,
    constraint map_points_key primary key (map_key, session, point),
    constraint map_points_session foreign key (map_key, session) references sessions (map_key, session) on delete cascade
) strict, without rowid;

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
    -- x y z in the session's frame, as float64; null if the client sent none.
    position blob,
    text text,
    description text,
    -- `created`, `observed`, or why it feeds no anchor.
    outcome text not null,
    anchor integer,
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
    constraint events_key primary key (map_key, seq),
    constraint events_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

create table loop_queries (
    map_key integer not null,
    id text not null,
    kept integer not null,
    body blob not null,
    constraint loop_queries_key primary key (map_key, id),
    constraint loop_queries_map foreign key (map_key) references maps (map_key) on delete cascade
) strict;

create index loop_queries_by_age on loop_queries (map_key, kept);
