-- Whether nothing measured how far a detected object is, so that its position is right in its bearing alone.
alter table detections add column range_assumed integer not null default 0 check (range_assumed in (0, 1));
