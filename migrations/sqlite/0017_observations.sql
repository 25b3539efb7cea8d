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
    declared blob not null,
    -- What the keyframe takes, as keyframes.bytes counts it.
    bytes integer not null,
    constraint keyframe_points_key primary key (map_key, keyframe),
    constraint keyframe_points_keyframe foreign key (map_key, keyframe)
        references keyframes (map_key, keyframe) on delete cascade
) strict, without rowid;

create table detection_points (
    map_key integer not null,
    keyframe integer not null,
    detection integer not null,
    -- A column of integers, ascending.
    map_points blob not null,
    constraint detection_points_key primary key (map_key, keyframe, detection),
    constraint detection_points_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
) strict, without rowid;
