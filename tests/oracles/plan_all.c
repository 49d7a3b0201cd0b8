/* SPDX-License-Identifier: BSD-3-Clause */
/* conus whose plans measure everything of every pose (plan_measure_all()), linked with --wrap=conus_plan_create. */
#include "selection/plan/plan.h"

conus_status __real_conus_plan_create(conus_plan **out, conus_selector *selector, const conus_constraint *constraints,
                                      size_t count, const conus_plan_options *options);
conus_status __wrap_conus_plan_create(conus_plan **out, conus_selector *selector, const conus_constraint *constraints,
                                      size_t count, const conus_plan_options *options);

conus_status __wrap_conus_plan_create(conus_plan **out, conus_selector *selector, const conus_constraint *constraints,
                                      size_t count, const conus_plan_options *options)
{
    conus_status status = __real_conus_plan_create(out, selector, constraints, count, options);
    if (!status) {
        plan_measure_all(*out);
    }
    return status;
}
