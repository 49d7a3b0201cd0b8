/* SPDX-License-Identifier: BSD-3-Clause */
/* The sizes of the public structs with pointers of 64 bits, which compiled callers rely on. A struct that begins with
 * struct_size may grow: its new members begin at its old size or behind it, not in padding at its old end. */
#include <conus/own.h>

#include <assert.h>

#if UINTPTR_MAX == UINT64_MAX
#define SIZE(type, size) static_assert(sizeof(type) == (size), "callers are compiled with this size of " #type)

SIZE(conus_load_options, 80);
SIZE(conus_pathway_options, 72);
SIZE(conus_context_options, 48);
SIZE(conus_context_map_options, 64);
SIZE(conus_transform_options, 72);
SIZE(conus_pose_options, 176);
SIZE(conus_probe_options, 24);
SIZE(conus_probe_contact, 88);
SIZE(conus_selector_options, 120);
SIZE(conus_tracker_options, 72);
SIZE(conus_jitter_options, 72);
SIZE(conus_report_options, 176);
SIZE(conus_grid_options, 16);
SIZE(conus_batch_options, 208);
SIZE(conus_pose_array, 72);
SIZE(conus_many_options, 32);
SIZE(conus_renderer_options, 72);
SIZE(conus_view, 264);
SIZE(conus_cut_view, 160);
SIZE(conus_mesh_options, 80);
SIZE(conus_phantom_options, 56);
SIZE(conus_manifest_options, 32);
SIZE(conus_catalogue_options, 24);
SIZE(conus_roi_options, 40);
SIZE(conus_place_options, 40);

SIZE(conus_voxels, 216);
SIZE(conus_create_options, 32);

SIZE(conus_note, 24);
SIZE(conus_installed, 64);
SIZE(conus_catalogue_place, 32);
SIZE(conus_label, 40);
SIZE(conus_band, 24);
SIZE(conus_object, 128);
SIZE(conus_volume_info, 512);
SIZE(conus_pose, 128);
SIZE(conus_pose_row, 296);
SIZE(conus_row_marks, 48);
SIZE(conus_pose_finding, 160);
SIZE(conus_pose_findings, 816);
SIZE(conus_brain_view, 40);
SIZE(conus_name_gap, 40);
SIZE(conus_name_check, 80);
SIZE(conus_cut_plane, 72);
SIZE(conus_result, 368);
SIZE(conus_evidence, 40);
SIZE(conus_interval, 32);
SIZE(conus_score_info, 24);
SIZE(conus_contacts, 24);
SIZE(conus_step, 16);
SIZE(conus_place, 104);
SIZE(conus_named_place, 128);
SIZE(conus_context_surface, 96);
SIZE(conus_frame, 160);
SIZE(conus_grid_view, 184);
SIZE(conus_batch_block, 48);
SIZE(conus_answers, 40);
SIZE(conus_pathway_transfer, 16);
SIZE(conus_drawn_point, 88);
SIZE(conus_drawn_probe, 16);
SIZE(conus_transfer_point, 40);
SIZE(conus_image_difference, 72);
SIZE(conus_phantom_info, 16);
SIZE(conus_streamlines_options, 56);
SIZE(conus_polylines, 72);
SIZE(conus_tract_scalar, 32);
SIZE(conus_streamline_list_view, 32);
SIZE(conus_tractogram_info, 144);
SIZE(conus_constraint, 136);
SIZE(conus_candidates, 128);
SIZE(conus_plan_options, 120);
SIZE(conus_verdict, 56);
SIZE(conus_planned, 312);
SIZE(conus_plan_faults, 24);
SIZE(conus_tolerance, 80);
SIZE(conus_tolerance_options, 120);
SIZE(conus_part, 48);
SIZE(conus_question, 128);
SIZE(conus_cover, 16);
SIZE(conus_so_far, 24);
SIZE(conus_together_options, 168);
SIZE(conus_chosen, 32);
SIZE(conus_combination, 80);
SIZE(conus_placed, 56);
SIZE(conus_conflict, 64);
#endif

extern int sizes_are_known;
int sizes_are_known = 1;
