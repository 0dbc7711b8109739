#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "candela/shot.h"

/// Work that is divided into pieces which machines do on their own.
namespace candela {

/// Some of a shot's pictures, or a part of the samples of one.
struct WorkPiece {
  PictureRange pictures;
  std::optional<PartRange> part = {};
};

/// Seconds of a shot on this machine.
struct WorkTimes {
  double start_s = 0.0;    ///< until the first sample: reading, building, compiling
  double picture_s = 0.0;  ///< of each picture
};

/// By a look at the first picture that takes some seconds beside its start. Of pictures that stop by noise it is what
/// all samples would take. Throws Error as Take does, Interrupted after a stop.
WorkTimes measure_work(Shot shot, const Job& job = {}, Diagnostics* diagnostics = nullptr);

/// In how many parts a picture of the shot can be made: its blocks of samples, or 1.
int most_parts(const Shot& shot);

/// Pieces that take about `piece_s` each, of about equal size: whole pictures where these are shorter, else parts of
/// one. A piece works at least as long as it starts.
std::vector<WorkPiece> divide_work(std::size_t pictures, int most_parts, const WorkTimes& times, double piece_s);

}  // namespace candela
