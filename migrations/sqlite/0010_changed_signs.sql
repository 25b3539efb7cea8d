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
