#pragma once

// Embree 3.13 and 4 through one set of names. Included by this folder's .cpp files only, except for RTC handles.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>

namespace candela::path {

#if RTC_VERSION_MAJOR >= 4
using RayContext = RTCRayQueryContext;
inline void init_context(RayContext& context) { rtcInitRayQueryContext(&context); }
/// Scenes whose queries may bring a filter of their own, for all geometries.
constexpr RTCSceneFlags kFilterByQuery = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
inline void intersect_1(RTCScene scene, RayContext& context, RTCRayHit& ray, RTCFilterFunctionN filter = nullptr) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  if (filter != nullptr) {
    arguments.filter = filter;
    arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
  }
  rtcIntersect1(scene, &ray, &arguments);
}
inline void intersect_16(const int* valid, RTCScene scene, RayContext& context, RTCRayHit16& rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &rays, &arguments);
}
inline void occluded_1(RTCScene scene, RayContext& context, RTCRay& ray, RTCFilterFunctionN filter = nullptr) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  if (filter != nullptr) {
    arguments.filter = filter;
    arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
  }
  rtcOccluded1(scene, &ray, &arguments);
}
#else
using RayContext = RTCIntersectContext;
inline void init_context(RayContext& context) { rtcInitIntersectContext(&context); }
constexpr RTCSceneFlags kFilterByQuery = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
inline void intersect_1(RTCScene scene, RayContext& context, RTCRayHit& ray, RTCFilterFunctionN filter = nullptr) {
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  context.filter = filter;
  rtcIntersect1(scene, &context, &ray);
}
inline void intersect_16(const int* valid, RTCScene scene, RayContext& context, RTCRayHit16& rays) {
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &context, &rays);
}
inline void occluded_1(RTCScene scene, RayContext& context, RTCRay& ray, RTCFilterFunctionN filter = nullptr) {
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  context.filter = filter;
  rtcOccluded1(scene, &context, &ray);
}
#endif

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, GeometryRelease>;

}  // namespace candela::path
