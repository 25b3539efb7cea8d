-- Large deletions and corrections are committed in one small transaction, and carried out in slices after it.

-- 1 if the map is deleted: its rows are removed in slices, and then this one. Its id is then one that no client can give.
alter table maps add column deleted integer not null default 0;

create index maps_deleted on maps (map_key) where deleted = 1;

-- Changes of poses and points that are committed, and not yet in the rows that they change. Versions apply in their order.
-- The parts of a version count from the moment that it has a row here.
create table deferred_changes (
    map_key integer not null,
    -- The version of the map that these changes make.
    version integer not null,
    parts integer not null,
    -- The first part that is not in the rows yet, and how many of its entries are.
    part integer not null,
    entries_done integer not null,
    constraint deferred_changes_key primary key (map_key, version),
    constraint deferred_changes_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

create table deferred_parts (
    map_key integer not null,
    version integer not null,
    part integer not null,
    -- `poses`, `points`, `forgotten`, `positions` or `touched`, and a packed list of them.
    kind text not null,
    entries blob not null,
    constraint deferred_parts_key primary key (map_key, version, part),
    constraint deferred_parts_map foreign key (map_key) references maps (map_key) on delete cascade
) strict;
