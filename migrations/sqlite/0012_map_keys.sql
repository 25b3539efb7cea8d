-- The key of a map is the database's to give, and is never given twice: what a process still holds of a deleted map must not
-- be taken for another map's.

-- One row: the key that was given last.
create table map_keys (
    only_row integer not null,
    last integer not null,
    constraint map_keys_key primary key (only_row)
) strict;

insert into map_keys (only_row, last) select 1, coalesce(max(map_key), 0) from maps;
