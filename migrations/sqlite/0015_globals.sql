-- Gravity, and the vector of a whole image.

-- float64 x y z: the unit vector of gravity in the frame of the map's sessions; null where it is not known.
alter table maps add column gravity blob;
-- float64 x y z: the unit vector of gravity in the camera frame; null where it is not known.
alter table keyframes add column gravity blob;

-- The vector of the whole image: the model that computed it, 'int8' or 'bits', and its numbers; null where none was sent.
alter table keyframes add column global_model text;
alter table keyframes add column global_encoding text;
alter table keyframes add column global_descriptor blob;
