-- History: what a map was sent, as far as its rows do not say it any more. `export` writes it as a recording.

-- The version of the map that each of these facts made; 0 for those of before, of which only the order of numbers is known.
alter table keyframes add column version integer not null default 0;
alter table model_readings add column version integer not null default 0;
alter table model_verdicts add column version integer not null default 0;

-- The anchor that the detection fed until it was deleted, and the version that deleted it; null where nobody did, or before
-- these columns.
alter table detections add column deleted_anchor integer;
alter table detections add column deleted_in integer;

create index detections_by_deleted_anchor on detections (map_key, deleted_anchor) where deleted_anchor is not null;
create index detections_by_deletion on detections (map_key, deleted_in) where deleted_in is not null;

-- The values that corrections, and keyframes that bring points again, replaced. What is not replaced has no row.
create table former_values (
    map_key integer not null,
    -- The version that replaced them.
    version integer not null,
    part integer not null,
    -- `former_poses`, `former_points`, `former_forgotten` or `former_positions`, and a packed list of them.
    kind text not null,
    entries blob not null,
    constraint former_values_key primary key (map_key, version, part),
    constraint former_values_map foreign key (map_key) references maps (map_key) on delete cascade
) strict;

-- What else was said of a map, in JSON: its properties, loops confirmed and revoked, descriptions by hand, anchors deleted.
create table operations (
    map_key integer not null,
    version integer not null,
    -- Tells the operations of one version apart.
    operation text not null,
    body text not null,
    constraint operations_key primary key (map_key, version, operation),
    constraint operations_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- What is known of the maps of before: how they are now.
insert into operations (map_key, version, operation, body)
select map_key, 0, 'map', json_object(
    'operation', 'map',
    'description', description,
    'metric', json(case metric when 0 then 'false' else 'true' end),
    'anchor_classes', (
        select json_group_array(class) from (select class from map_anchor_classes c where c.map_key = m.map_key order by class)
    ),
    'settings', (select json_group_object(name, value) from map_settings s where s.map_key = m.map_key)
)
from maps m;

insert into operations (map_key, version, operation, body)
select map_key, 0, 'loop ' || id, json_object(
    'operation', 'loop', 'id', id, 'keyframe', keyframe, 'candidate', candidate, 'query', query
)
from loops;

insert into operations (map_key, version, operation, body)
select map_key, 0, 'description ' || anchor, json_object(
    'operation', 'description', 'anchor', anchor, 'text', description_by_hand
)
from anchors where description_by_hand is not null;
