-- The figures that a list of maps shows, kept beside the map's version: each commit writes them with it, so that
-- a list reads no map. They follow from the facts; `revisit check` holds the two against each other.

alter table maps add column keyframes integer not null default 0;
-- Merged ones counted once.
alter table maps add column anchors integer not null default 0;
alter table maps add column sessions integer not null default 0;
alter table maps add column loops integer not null default 0;
-- What the map's facts take on disk.
alter table maps add column bytes integer not null default 0;
-- What its index takes in memory, as last estimated: how much room is made before it is loaded. A hint, never checked.
alter table maps add column memory_bytes integer not null default 0;

-- For the maps that are there: counted from their rows.
update maps set
    keyframes = (select count(*) from keyframes k where k.map_key = maps.map_key),
    anchors = (select count(*) from anchors a where a.map_key = maps.map_key),
    sessions = (select count(*) from sessions s where s.map_key = maps.map_key),
    loops = (select count(*) from loops l where l.map_key = maps.map_key),
    bytes =
        coalesce((select sum(k.bytes) from keyframes k where k.map_key = maps.map_key), 0)
        + coalesce((select sum(octet_length(s.id)) from sessions s where s.map_key = maps.map_key), 0)
        + coalesce((
            select sum(8 + octet_length(l.id) + octet_length(l.keyframe_id) + octet_length(l.candidate_id)
                + coalesce(octet_length(l.query), 0))
            from loops l where l.map_key = maps.map_key
        ), 0)
        + coalesce((select sum(8 + octet_length(m.loop_id)) from anchor_merges m where m.map_key = maps.map_key), 0)
        + 32 * (select count(*) from map_points p where p.map_key = maps.map_key),
    memory_bytes = coalesce((
        select sum(1024 + 3 * octet_length(k.bow_words) + 8 * octet_length(k.observes))
        from keyframes k where k.map_key = maps.map_key
    ), 0);

-- Anchors that links join are one: each set of them counts once, by its oldest.
update maps set anchors = maps.anchors - joined.anchors + joined.objects
from (
    with recursive
        linked (map_key, anchor) as (
            select map_key, into_anchor from anchor_merges union select map_key, from_anchor from anchor_merges
        ),
        -- From every anchor that has no link to an older one; most sets have one such anchor.
        reached (map_key, start, anchor) as (
            select l.map_key, l.anchor, l.anchor from linked l
            where not exists (
                select 1 from anchor_merges m
                where m.map_key = l.map_key and m.from_anchor = l.anchor and m.into_anchor < l.anchor
            ) and not exists (
                select 1 from anchor_merges m
                where m.map_key = l.map_key and m.into_anchor = l.anchor and m.from_anchor < l.anchor
            )
            union
            select r.map_key, r.start, m.from_anchor from reached r
            join anchor_merges m on m.map_key = r.map_key and m.into_anchor = r.anchor
            union
            select r.map_key, r.start, m.into_anchor from reached r
            join anchor_merges m on m.map_key = r.map_key and m.from_anchor = r.anchor
        ),
        objects (map_key, start) as (
            select map_key, start from reached group by map_key, start having min(anchor) = start
        )
    select
        a.map_key as map_key,
        a.count as anchors,
        (select count(*) from objects o where o.map_key = a.map_key) as objects
    from (select map_key, count(*) as count from linked group by map_key) a
) as joined
where joined.map_key = maps.map_key;
