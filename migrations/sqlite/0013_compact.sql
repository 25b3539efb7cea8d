-- Fewer pages a keyframe: map points in blocks, and numbers in as few bytes as they need.

-- Map points, 64 numbers to a row: a row of its own took twice the bytes of a position.
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

-- How the numbers of a row are packed: 0 with a fixed width, as the comments of their tables say; 1 as columns that tell their
-- own width.
alter table keyframes add column packing integer not null default 0;
alter table keyframe_features add column packing integer not null default 0;
