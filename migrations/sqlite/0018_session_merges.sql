-- Sessions that became one with another. The rows in keyframes keep the session that was sent.

create table session_merges (
    map_key integer not null,
    version integer not null,
    -- The session that went, and the one that its keyframes are of from then on.
    session integer not null,
    into_session integer not null,
    -- The number that the next keyframe had: it, and those after it, are not concerned.
    next_keyframe integer not null,
    -- What revokes the merge beside the former values of its version, as JSON; null once something was written on top of it.
    undo text,
    constraint session_merges_key primary key (map_key, version),
    constraint session_merges_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Whether a feature sent with a point that renamed_from does not list observes none.
alter table keyframe_points add column renames_all integer not null default 0;

alter table events add column session text;
alter table events add column into_session text;
