// Revisit for C++17: include this one file, link libcurl, and zstd where REVISIT_WITH_ZSTD is defined.
#pragma once

#include "base64.hpp"
#include "client.hpp"
#include "geometry.hpp"
#include "http.hpp"
#include "json.hpp"
#include "keyframe.hpp"
#include "keyframe_json.hpp"
#include "number_text.hpp"
#include "operations.hpp"
#include "result.hpp"
#include "sender.hpp"
#include "updates.hpp"
#include "verdict.hpp"
