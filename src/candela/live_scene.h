#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "candela/drawing_thread.h"
#include "candela/shot.h"

namespace candela {

/// What live scenes share: environments by their names, and the thread that draws. For any number of threads.
class LiveStage {
 public:
  /// make_environment(), again where the file has changed.
  std::shared_ptr<const Environment> environment(const std::string& name, Diagnostics* diagnostics = nullptr);
  /// Started by the first call.
  DrawingThread& drawing();

 private:
  struct Loaded {
    std::string state;  ///< of the file
    std::shared_ptr<const Environment> environment;
    Diagnostics diagnostics;
  };
  std::mutex mutex_;  ///< of the environments
  std::map<std::string, Loaded> environments_;
  std::mutex drawing_mutex_;
  std::unique_ptr<DrawingThread> drawing_;
};

/// What a change of a scene touches.
enum class Change {
  cameras,    ///< cameras, the nodes that hold nothing else, and names: nothing that is prepared
  lamps,      ///< lamps, and the nodes that hold nothing else
  materials,  ///< materials and textures
  all
};

/// A picture of a live scene. TakenPicture::scene is there where the shot has masks: as it stands in the picture, so
/// that the next change copies the scene as long as that is held.
struct LivePicture {
  TakenPicture taken;
  View view;  ///< that it was taken through
  /// The same for pictures of one LiveScene.
  std::weak_ptr<const void> taken_of = {};
};

/// A scene in memory that is changed and shown again. What an engine has made of it serves the next picture as far as
/// no change has touched it. To be read and changed by one thread at a time, while others may make pictures.
class LiveScene {
 public:
  LiveScene(Scene scene, std::shared_ptr<LiveStage> stage);
  ~LiveScene();
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  const Scene& scene() const { return *scene_; }
  /// The scene as it stands: no change touches it while it is held.
  std::shared_ptr<const Scene> snapshot() const;
  /// The scene to be changed, until the next picture is begun. Pictures that are begun see none of it.
  Scene& change(Change what);
  /// The same of one mesh: what its parts consist of.
  Mesh& change_mesh(std::size_t mesh);

  struct Engines;
  struct Prepared;
  /// The scene as it stands, for one picture.
  class Moment {
   public:
    /// `light` stands for the environment that the shot names; null = that, or the scene's own. Throws Error, and
    /// Interrupted after a stop before there is a picture.
    LivePicture render(const std::shared_ptr<const Environment>& light, Diagnostics* diagnostics, const Job& job) const;

   private:
    friend class LiveScene;
    std::shared_ptr<const Environment> environment(const std::shared_ptr<const Environment>& light,
                                                   Diagnostics* diagnostics) const;
    void choose_view(Diagnostics* diagnostics, std::string& camera, View& view) const;
    TakenPicture trace(const View& view, const Prepared& wanted, const Environment& lit, const DevelopSettings& develop,
                       const Job& job) const;
    TakenPicture draw(const View& view, const Prepared& wanted, const Environment& lit, const Job& job) const;

    void complete(LivePicture& picture, Diagnostics* diagnostics) const;

    Shot shot_;
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const int> is_in_use_;
    std::uint64_t shapes_ = 0, materials_ = 0, lamps_ = 0;
    std::shared_ptr<LiveStage> stage_;
    std::shared_ptr<Engines> engines_;
  };
  /// Begins a picture, on the ground that the shot lays. The shot's file, its variants, its animations and whatever
  /// asks for several pictures count for nothing. Throws Error where a mesh lacks what its material reads.
  Moment begin(Shot shot);

 private:
  void complete();

  std::shared_ptr<Scene> scene_;
  std::shared_ptr<LiveStage> stage_;
  std::shared_ptr<const int> is_in_use_;                  ///< shared with moments of scene_
  std::uint64_t shapes_ = 1, materials_ = 1, lamps_ = 1;  ///< grow with every change
  std::uint64_t completed_ = 0;  ///< shapes_ + materials_ for which every mesh has what is read of it
  std::shared_ptr<Engines> engines_;
};

}  // namespace candela
