/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Embree 3 and Embree 4 as one: CMake says which it has found. */
#ifndef CONUS_SELECTION_ENGINE_TRIANGLES_EMBREE_H
#define CONUS_SELECTION_ENGINE_TRIANGLES_EMBREE_H

#if CONUS_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "base/library.h"

#include <stdbool.h>
#include <stddef.h>

#if CONUS_EMBREE >= 4
#define EMBREE_OCCLUDED(F) F(rtc, Occluded1)
#else
#define EMBREE_OCCLUDED(F) F(rtc, Occluded1M)
#endif
/* clang-format off */
#define EMBREE_FUNCTIONS(F)                                                                                            \
    EMBREE_OCCLUDED(F)                                                                                                 \
    F(rtc, AttachGeometryByID) F(rtc, CommitGeometry) F(rtc, CommitScene) F(rtc, GetDeviceError) F(rtc, Intersect1)    \
    F(rtc, Intersect16) F(rtc, Intersect4) F(rtc, Intersect8) F(rtc, NewDevice) F(rtc, NewGeometry) F(rtc, NewScene)   \
    F(rtc, ReleaseDevice) F(rtc, ReleaseGeometry) F(rtc, ReleaseScene) F(rtc, SetDeviceErrorFunction)                  \
    F(rtc, SetGeometryInstancedScene) F(rtc, SetGeometryTransform) F(rtc, SetNewGeometryBuffer) F(rtc, SetSceneFlags)  \
    F(rtc, SetSharedGeometryBuffer)
/* clang-format on */

/** rtcNewDevice() and the others, once Embree is loaded. */
static struct {
    EMBREE_FUNCTIONS(LIBRARY_MEMBER)
} rtc;

/** Goes with rays into a scene. Filters get the address of its context, which is its own. */
struct embree_query {
#if CONUS_EMBREE >= 4
    struct RTCRayQueryContext context;
    struct RTCIntersectArguments nearest;
    struct RTCOccludedArguments any; /**< The same members, of another type. */
#else
    struct RTCIntersectContext context;
#endif
};

/** Fills @p out for rays that Embree reports to @p filter. It refers to itself: it must stay where it is. */
static inline void embree_query_init(struct embree_query *out, RTCFilterFunctionN filter, bool coherent)
{
#if CONUS_EMBREE >= 4
    const enum RTCRayQueryFlags flags = (coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT) |
                                        RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    rtcInitRayQueryContext(&out->context);
    rtcInitIntersectArguments(&out->nearest);
    rtcInitOccludedArguments(&out->any);
    out->nearest.context = out->any.context = &out->context;
    out->nearest.filter = out->any.filter = filter;
    out->nearest.flags = out->any.flags = flags;
#else
    rtcInitIntersectContext(&out->context);
    out->context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    out->context.filter = filter;
#endif
}

/** Lets filters of queries be called for all that is in the scene. */
static inline void embree_allow_filters(RTCScene scene)
{
#if CONUS_EMBREE >= 4
    rtc.SetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS);
#else
    rtc.SetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
#endif
}

/* The arguments of rtcIntersect in each edition, after the mask of valid rays. */
#if CONUS_EMBREE >= 4
#define EMBREE_NEAREST(query, scene, packet) scene, packet, &(query)->nearest
#else
#define EMBREE_NEAREST(query, scene, packet) scene, &(query)->context, packet
#endif

/** Sends @p width rays, 1, 4, 8 or 16, for what is nearest. */
static inline void embree_intersect(struct embree_query *query, RTCScene scene, const int *valid, void *packet,
                                    unsigned width)
{
    switch (width) {
    case 16:
        rtc.Intersect16(valid, EMBREE_NEAREST(query, scene, packet));
        break;
    case 8:
        rtc.Intersect8(valid, EMBREE_NEAREST(query, scene, packet));
        break;
    case 4:
        rtc.Intersect4(valid, EMBREE_NEAREST(query, scene, packet));
        break;
    default:
        rtc.Intersect1(EMBREE_NEAREST(query, scene, packet));
    }
}

#undef EMBREE_NEAREST

/** Sends @p count rays, each @p size bytes behind the one before, for any hit. Embree 4 has no streams. */
static inline void embree_occlude(struct embree_query *query, RTCScene scene, struct RTCRay *rays, size_t count,
                                  size_t size)
{
#if CONUS_EMBREE >= 4
    for (size_t i = 0; i < count; i++) {
        rtc.Occluded1(scene, (struct RTCRay *)((char *)rays + i * size), &query->any);
    }
#else
    rtc.Occluded1M(scene, &query->context, rays, (unsigned)count, size);
#endif
}

#endif
