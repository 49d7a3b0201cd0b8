/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws batches of leaves, and passes on the runs that the driver proposes. */
#include "render/id/tract_pass.h"

#include "atlas/tracts/tract_start.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/gl/shader_list.h"
#include "render/gl/shaders.h"
#include "render/gl/target.h"

struct box {
    double low[3], high[3];
};

/* The ball round a box that is grown on all sides; returns its radius. */
static double ball_round(double centre[3], const struct box *box, double grown)
{
    double half[3];
    for (int a = 0; a < 3; a++) {
        centre[a] = 0.5 * (box->low[a] + box->high[a]);
        half[a] = 0.5 * (box->high[a] - box->low[a]);
    }
    return vec3_length(half) + grown;
}

static bool is_shown(const struct tract_source *source, uint64_t point)
{
    return !source->shown || source->shown[tractogram_streamline_of(source->tractogram, point)];
}

/* How far capsules reach beyond the boxes of their points, with a margin far above rounding. */
static double growth_of(const struct tractogram *tractogram)
{
    double reach = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(tractogram->low[a]), fabs(tractogram->high[a])));
    }
    return tractogram->radius + TRACT_SLACK * (reach + tractogram->radius);
}

/* The clusters of a group, appended to the others, and the group's ball; an empty one without clusters. */
static void add_group(struct clusters *to, const struct tract_source *source, size_t first, size_t end)
{
    const struct tract_tree *tree = &source->tractogram->tree;
    double grown = growth_of(source->tractogram);
    size_t group = to->mesh_count++;
    size_t count = to->first_cluster[group];
    struct box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t number = first; number < end; number++) {
        const struct tract_leaf *leaf = &tree->leaves[number];
        bool shows = !source->shown;
        for (size_t lane = 0; lane < leaf->count && !shows; lane++) {
            shows = is_shown(source, leaf->point[lane]);
        }
        if (shows) {
            struct cluster *cluster = &to->cluster[count++];
            const struct tract_node *node = &tree->nodes[number / TRACT_WIDTH]; /* those above leaves come first */
            struct box box;
            for (int a = 0; a < 3; a++) {
                box.low[a] = (double)node->low[a][number % TRACT_WIDTH];
                box.high[a] = (double)node->high[a][number % TRACT_WIDTH];
                all.low[a] = fmin(all.low[a], box.low[a]);
                all.high[a] = fmax(all.high[a], box.high[a]);
            }
            cluster->radius = ball_round(cluster->centre, &box, grown);
            cluster->first = (uint32_t)number;
            cluster->count = leaf->count;
        }
    }
    double centre[3] = {0, 0, 0};
    to->ball[3][group] = count > to->first_cluster[group] ? ball_round(centre, &all, grown) : 0;
    for (int a = 0; a < 3; a++) {
        to->ball[a][group] = centre[a];
    }
    to->first_cluster[to->mesh_count] = count;
}

conus_status tract_clusters_init(struct clusters *out, const struct tract_source *source)
{
    struct clusters clusters = {0};
    size_t leaves = tract_leaf_count(source->tractogram->tree.run_count);
    size_t size = 1; /* of groups: about as many leaves in a group as there are groups */
    while (size * size < leaves) {
        size *= 2;
    }
    size_t groups = (leaves + size - 1) / size;
    bool is_whole = true;
    for (int k = 0; k < 4; k++) {
        clusters.ball[k] = memory_raw(groups, sizeof(double));
        is_whole = is_whole && clusters.ball[k];
    }
    clusters.first_cluster = memory_zeroed(groups + 1, sizeof *clusters.first_cluster);
    clusters.cluster = memory_zeroed(leaves, sizeof *clusters.cluster);
    if (!is_whole || !clusters.first_cluster || !clusters.cluster) {
        clusters_finish(&clusters);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0; first < leaves; first += size) {
        add_group(&clusters, source, first, first + size < leaves ? first + size : leaves);
    }
    *out = clusters;
    return CONUS_OK;
}

uint64_t tract_texels_size(const struct tractogram *tractogram)
{
    return (uint64_t)tract_leaf_count(tractogram->tree.run_count) * TRACT_LEAF_TEXELS * 4 * sizeof(uint32_t);
}

void tract_texels_fill(uint32_t out[TRACT_LEAF_TEXELS][4], const struct tract_source *source, size_t number)
{
    const struct tract_leaf *leaf = &source->tractogram->tree.leaves[number];
    memset(out, 0, TRACT_LEAF_TEXELS * sizeof *out);
    memcpy(out[0], leaf->low, sizeof leaf->low);
    memcpy(&out[0][3], &leaf->thickness, sizeof leaf->thickness);
    memcpy(out[1], leaf->step, sizeof leaf->step);
    for (uint32_t lane = 0; lane < leaf->count; lane++) {
        uint32_t *run = out[2 + lane / 2] + 2 * (lane % 2);
        uint32_t multiple = leaf->bend[lane] >> TRACT_SEGMENTS_BITS;
        run[0] = leaf->ends[0][0][lane] | (uint32_t)leaf->ends[0][1][lane] << 8 |
                 (uint32_t)leaf->ends[0][2][lane] << 16 | multiple << 24;
        run[1] = leaf->ends[1][0][lane] | (uint32_t)leaf->ends[1][1][lane] << 8 |
                 (uint32_t)leaf->ends[1][2][lane] << 16 | (is_shown(source, leaf->point[lane]) ? TRACT_SHOWN : 0);
    }
}

enum { LEAF_UNIT, RAY_UNIT };
enum { NEAREST_BUFFER, HIT_BUFFER };
/* A run is a box of two triangles, whose corners are its vertices. */
enum { BOX_CORNERS = 4, BOX_INDICES = 6, RAY_TEXELS = 2, FIRST_HITS = 4096 };
/* Runs of a batch. On a GPU each batch is waited for. */
enum { BATCH = 16384, SOFTWARE_BATCH = 1024 };
/* Queries are under way side by side while they have at most SLOT_PIXELS pixels, and their culling takes at most
 * SLOT_MEMORY bytes. */
enum { SLOT_LIMIT = 256, SLOT_PIXELS = 1 << 18, SLOT_MEMORY = 1 << 28 };

/* Leaves whose vertices' numbers, which are signed, do not overflow. */
static const size_t leaf_limit = INT32_MAX / (BOX_CORNERS * TRACT_LEAF);

/* Less slack than this counts as this, so that its square is a normal number; 0 marks a pixel without a ray. */
static const float least_slack = 1e-18F;

/* A query under way. */
struct slot {
    const struct tract_query *query;
    struct mesh_cull *cull;
    const uint32_t *batch; /* leaves by cluster, borrowed from cull */
    size_t count;
    size_t place; /* place of its pixels among those of all slots */
    float slack;  /* the largest slack of its rays */
};

/* A tractogram on the device. */
struct scene {
    const struct tractogram *tractogram;
    struct clusters clusters;
    struct slot *slots; /* [SLOT_LIMIT], the first slot_count have a cull */
    size_t slot_count;
    GLuint leaf_buffer, leaves;
};

/* A ray in the texture of rays. */
struct ray_texels {
    float origin[3], slack, direction[3], unused;
};

struct tract_pass {
    size_t scene_count, batch;
    GLuint program, vertices, index_buffer, nearest_buffer, ray_buffer, rays;
    GLint apex, device_from_world, parallel, width, radius, slack, resolution, first_pixel, pixels, has_bound;
    struct target target; /* without pixels: results go to the list */
    struct shader_list hits;
    struct ray_texels *texels; /* [pixel_capacity] of all slots' pixels */
    double *along;             /* likewise: how far along its ray each search begins */
    float *nearest;            /* likewise: how far it gets */
    size_t pixel_capacity;
    GLsizei *draw_counts; /* [draw_capacity] */
    const void **draw_offsets;
    GLint *draw_bases;
    size_t draw_capacity;
    struct scene scenes[];
};

/* The state of one call of tract_pass_render() for one scene. */
struct search {
    struct tract_pass *pass;
    size_t source;
    const struct tract_query *queries;
    const struct tract_query *next, *end; /* queries that have not begun */
    size_t slots;                         /* that are under way */
    struct slot *slot_at[SLOT_LIMIT];     /* by place */
    size_t pixels, all_pixels;            /* of a query, and of all slots */
    tract_pass_take take;
    void *user;
};

static conus_status create_program(struct tract_pass *pass)
{
    static const struct program_define defines[] = {
        {"LEAF_UNIT", LEAF_UNIT},   {"RAY_UNIT", RAY_UNIT},    {"NEAREST_BUFFER", NEAREST_BUFFER},
        {"HIT_BUFFER", HIT_BUFFER}, {"LEAF_RUNS", TRACT_LEAF}, {"LEAF_TEXELS", TRACT_LEAF_TEXELS},
        {"SHOWN", TRACT_SHOWN}};
    const struct program_source source = {.vertex = {"tract_id.vert.glsl", shader_tract_id_vert},
                                          .fragment = {"tract_id.frag.glsl", shader_tract_id_frag},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    conus_status status = program_create(&pass->program, &source);
    if (!status) {
        pass->apex = program_uniform(pass->program, "apex");
        pass->device_from_world = program_uniform(pass->program, "device_from_world");
        pass->parallel = program_uniform(pass->program, "parallel");
        pass->width = program_uniform(pass->program, "width");
        pass->radius = program_uniform(pass->program, "radius");
        pass->slack = program_uniform(pass->program, "slack");
        pass->resolution = program_uniform(pass->program, "resolution");
        pass->first_pixel = program_uniform(pass->program, "first_pixel");
        pass->pixels = program_uniform(pass->program, "pixels");
        pass->has_bound = program_uniform(pass->program, "has_bound");
    }
    return status;
}

/* Draws two triangles for the box of each run of a leaf. */
static void create_indices(struct tract_pass *pass)
{
    static const uint16_t box[BOX_INDICES] = {0, 1, 2, 2, 1, 3};
    uint16_t indices[TRACT_LEAF * BOX_INDICES];
    for (unsigned i = 0; i < TRACT_LEAF * BOX_INDICES; i++) {
        indices[i] = (uint16_t)(box[i % BOX_INDICES] + i / BOX_INDICES * BOX_CORNERS);
    }
    glCreateBuffers(1, &pass->index_buffer);
    glNamedBufferStorage(pass->index_buffer, sizeof indices, indices, 0);
    glCreateVertexArrays(1, &pass->vertices);
    glVertexArrayElementBuffer(pass->vertices, pass->index_buffer);
}

static conus_status upload_leaves(struct scene *scene, const struct tract_source *source)
{
    enum { AT_ONCE = 256 };
    size_t leaves = tract_leaf_count(source->tractogram->tree.run_count);
    uint32_t(*texels)[TRACT_LEAF_TEXELS][4] = memory_raw(AT_ONCE, sizeof *texels);
    if (!texels) {
        return CONUS_ERROR_MEMORY;
    }
    glCreateBuffers(1, &scene->leaf_buffer);
    glNamedBufferStorage(scene->leaf_buffer, (GLsizeiptr)tract_texels_size(source->tractogram), NULL,
                         GL_DYNAMIC_STORAGE_BIT);
    for (size_t first = 0, count; first < leaves; first += count) {
        count = leaves - first < AT_ONCE ? leaves - first : AT_ONCE;
        for (size_t i = 0; i < count; i++) {
            tract_texels_fill(texels[i], source, first + i);
        }
        glNamedBufferSubData(scene->leaf_buffer, (GLintptr)(first * sizeof *texels),
                             (GLsizeiptr)(count * sizeof *texels), texels);
    }
    memory_free(texels);
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &scene->leaves);
    glTextureBuffer(scene->leaves, GL_RGBA32UI, scene->leaf_buffer);
    return gl_check("streamlines");
}

bool tract_pass_fits(const struct tract_source *sources, size_t count, uint64_t memory_left)
{
    GLint texels = 0;
    uint64_t size = 0;
    bool fits = true;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    for (size_t i = 0; i < count; i++) {
        size_t leaves = tract_leaf_count(sources[i].tractogram->tree.run_count);
        fits = fits && leaves > 0 && leaves <= leaf_limit && leaves <= (size_t)texels / TRACT_LEAF_TEXELS;
        size += tract_texels_size(sources[i].tractogram);
    }
    return fits && size <= memory_left;
}

conus_status tract_pass_create(struct tract_pass **out, const struct tract_source *sources, size_t count,
                               uint64_t *memory_left)
{
    struct tract_pass *pass = memory_zeroed(1, sizeof *pass + count * sizeof pass->scenes[0]);
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    pass->batch = gl_is_software() ? SOFTWARE_BATCH : BATCH;
    conus_status status = shader_list_init(&pass->hits, 3 * sizeof(uint32_t), FIRST_HITS);
    status = status ? status : create_program(pass);
    if (!status) {
        create_indices(pass);
    }
    for (size_t i = 0; i < count && !status; i++) {
        struct scene *scene = &pass->scenes[pass->scene_count++];
        scene->tractogram = sources[i].tractogram;
        scene->slots = memory_zeroed(SLOT_LIMIT, sizeof *scene->slots);
        status = scene->slots ? CONUS_OK : CONUS_ERROR_MEMORY;
        status = status ? status : tract_clusters_init(&scene->clusters, &sources[i]);
        status = status ? status : upload_leaves(scene, &sources[i]);
        *memory_left -= status ? 0 : tract_texels_size(sources[i].tractogram);
    }
    if (status) {
        tract_pass_destroy(pass);
        return status;
    }
    *out = pass;
    return CONUS_OK;
}

void tract_pass_destroy(struct tract_pass *pass)
{
    if (!pass) {
        return;
    }
    const GLuint buffers[] = {pass->index_buffer, pass->nearest_buffer, pass->ray_buffer};
    for (size_t i = 0; i < pass->scene_count; i++) {
        glDeleteTextures(1, &pass->scenes[i].leaves);
        glDeleteBuffers(1, &pass->scenes[i].leaf_buffer);
        for (size_t n = 0; n < pass->scenes[i].slot_count; n++) {
            mesh_cull_destroy(pass->scenes[i].slots[n].cull);
        }
        memory_free(pass->scenes[i].slots);
        clusters_finish(&pass->scenes[i].clusters);
    }
    glDeleteTextures(1, &pass->rays);
    glDeleteBuffers(3, buffers);
    glDeleteVertexArrays(1, &pass->vertices);
    glDeleteProgram(pass->program);
    target_finish(&pass->target);
    shader_list_finish(&pass->hits);
    memory_free(pass->texels);
    memory_free(pass->along);
    memory_free(pass->nearest);
    memory_free(pass->draw_counts);
    memory_free((void *)pass->draw_offsets);
    memory_free(pass->draw_bases);
    memory_free(pass);
}

/* Reserves that many pixels of all slots together. */
static conus_status reserve_pixels(struct tract_pass *pass, size_t pixels)
{
    if (pass->pixel_capacity >= pixels) {
        return CONUS_OK;
    }
    pass->pixel_capacity = 0;
    memory_free(pass->texels);
    memory_free(pass->along);
    memory_free(pass->nearest);
    pass->texels = memory_raw(pixels, sizeof *pass->texels);
    pass->along = memory_raw(pixels, sizeof *pass->along);
    pass->nearest = memory_raw(pixels, sizeof *pass->nearest);
    if (!pass->texels || !pass->along || !pass->nearest) {
        return CONUS_ERROR_MEMORY;
    }
    pass->pixel_capacity = pixels;
    if (!pass->rays) {
        glCreateBuffers(1, &pass->nearest_buffer);
        glCreateBuffers(1, &pass->ray_buffer);
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &pass->rays);
    }
    glNamedBufferData(pass->nearest_buffer, (GLsizeiptr)(pixels * sizeof *pass->nearest), NULL, GL_DYNAMIC_COPY);
    glNamedBufferData(pass->ray_buffer, (GLsizeiptr)(pixels * sizeof *pass->texels), NULL, GL_STREAM_DRAW);
    glTextureBuffer(pass->rays, GL_RGBA32F, pass->ray_buffer);
    return gl_check("rays of streamlines");
}

/* Uploads the query's rays, from where each of them enters the scene. */
static void aim(const struct search *search, struct slot *slot)
{
    const struct tract_pass *pass = search->pass;
    size_t first = slot->place * search->pixels;
    slot->slack = least_slack;
    for (size_t i = 0; i < search->pixels; i++) {
        struct ray_texels *texels = &pass->texels[first + i];
        struct tract_start start;
        *texels = (struct ray_texels){.slack = 0};
        pass->along[first + i] = 0;
        if ((!slot->query->wanted || slot->query->wanted[i]) &&
            tract_start_find(&start, pass->scenes[search->source].tractogram, slot->query->origins[i],
                             slot->query->directions[i])) {
            memcpy(texels->origin, start.origin, sizeof start.origin);
            memcpy(texels->direction, start.direction, sizeof start.direction);
            texels->slack = start.slack > least_slack ? start.slack : least_slack;
            pass->along[first + i] = start.along;
            slot->slack = texels->slack > slot->slack ? texels->slack : slot->slack;
        }
    }
    glNamedBufferSubData(pass->ray_buffer, (GLintptr)(first * sizeof *pass->texels),
                         (GLsizeiptr)(search->pixels * sizeof *pass->texels), pass->texels + first);
}

/* How far along its search a pixel, number `at` of all, may still find something. */
static float reach_of(const struct tract_pass *pass, const struct slot *slot, size_t at, size_t pixel)
{
    if (!slot->query->distances) {
        return INFINITY;
    }
    float reach = tract_start_reach(slot->query->distances[pixel], pass->along[at], pass->texels[at].slack);
    return reach > 0 ? reach : 0; /* the driver compares bits */
}

/* Gives the slot its query's next batch, or the first one of the next query; false when there is none. */
static bool feed(struct search *search, struct slot *slot)
{
    slot->count = 0;
    while (!slot->count && (slot->query || search->next < search->end)) {
        bool begins = !slot->query;
        if (begins) {
            slot->query = search->next++;
            mesh_cull_begin(slot->cull, &slot->query->view);
        }
        mesh_cull_hide(slot->cull, slot->query->distances);
        slot->count = mesh_cull_batch(&slot->batch, slot->cull, search->pass->batch);
        if (slot->count && begins) {
            aim(search, slot);
        }
        slot->query = slot->count ? slot->query : NULL;
    }
    return slot->count > 0;
}

/* Feeds the slots and moves those under way to the front. */
static void feed_all(struct search *search)
{
    struct slot *slots = search->pass->scenes[search->source].slots;
    for (size_t i = 0; i < search->slots;) {
        if (feed(search, &slots[i])) {
            search->slot_at[slots[i].place] = &slots[i];
            const struct tract_pass *pass = search->pass;
            size_t first = slots[i].place * search->pixels;
            for (size_t pixel = 0; pixel < search->pixels; pixel++) {
                pass->nearest[first + pixel] = reach_of(pass, &slots[i], first + pixel, pixel);
            }
            glNamedBufferSubData(pass->nearest_buffer, (GLintptr)(first * sizeof *pass->nearest),
                                 (GLsizeiptr)(search->pixels * sizeof *pass->nearest), pass->nearest + first);
            i++;
        } else {
            struct slot idle = slots[i];
            slots[i] = slots[--search->slots];
            slots[search->slots] = idle;
        }
    }
}

/* Makes slots for the queries, or as many as are allowed, and the memory for their pixels. */
static conus_status begin_slots(struct search *search)
{
    struct tract_pass *pass = search->pass;
    struct scene *scene = &pass->scenes[search->source];
    size_t count = (size_t)(search->end - search->next);
    size_t most = SLOT_PIXELS / search->pixels > 1 ? SLOT_PIXELS / search->pixels : 1;
    size_t wanted = count < most ? count : most;
    size_t fitting = SLOT_MEMORY / pass->scene_count / mesh_cull_size(&scene->clusters);
    size_t limit = fitting < 1 ? 1 : fitting < SLOT_LIMIT ? fitting : SLOT_LIMIT;
    conus_status status = CONUS_OK;
    while (scene->slot_count < wanted && scene->slot_count < limit && !status) {
        status = mesh_cull_create(&scene->slots[scene->slot_count].cull, &scene->clusters);
        scene->slot_count += !status;
    }
    search->slots = count < scene->slot_count ? count : scene->slot_count;
    search->slots = search->slots < most ? search->slots : most;
    for (size_t i = 0; i < search->slots; i++) { /* left over from a query that failed */
        scene->slots[i].query = NULL;
        scene->slots[i].place = i;
    }
    search->all_pixels = search->slots * search->pixels;
    return status ? status : reserve_pixels(pass, search->all_pixels);
}

static conus_status reserve_draws(struct tract_pass *pass, size_t count)
{
    if (pass->draw_capacity >= count) {
        return CONUS_OK;
    }
    pass->draw_capacity = 0;
    memory_free(pass->draw_counts);
    memory_free((void *)pass->draw_offsets);
    memory_free(pass->draw_bases);
    pass->draw_counts = memory_raw(count, sizeof *pass->draw_counts);
    pass->draw_offsets = memory_zeroed(count, sizeof *pass->draw_offsets); /* all begin with the first index */
    pass->draw_bases = memory_raw(count, sizeof *pass->draw_bases);
    if (!pass->draw_counts || !pass->draw_offsets || !pass->draw_bases) {
        return CONUS_ERROR_MEMORY;
    }
    pass->draw_capacity = count;
    return CONUS_OK;
}

static conus_status draw_slot(const struct search *search, const struct slot *slot)
{
    struct tract_pass *pass = search->pass;
    const struct clusters *clusters = &pass->scenes[search->source].clusters;
    const struct mesh_view *view = &slot->query->view;
    const double *m = view->world_from_device;
    bool parallel = view->radius > 0;
    conus_status status = reserve_draws(pass, slot->count);
    if (status) {
        return status;
    }
    for (size_t i = 0; i < slot->count; i++) {
        const struct cluster *leaf = &clusters->cluster[slot->batch[i]];
        pass->draw_counts[i] = (GLsizei)(leaf->count * BOX_INDICES);
        pass->draw_bases[i] = (GLint)(leaf->first * TRACT_LEAF * BOX_CORNERS);
    }
    double rows[9];
    for (int a = 0; a < 3; a++) {
        rows[a] = m[a];
        rows[3 + a] = m[4 + a];
        rows[6 + a] = -m[8 + a];
    }
    glUniform3dv(pass->apex, 1, m + 12);
    glUniformMatrix3dv(pass->device_from_world, 1, GL_TRUE, rows);
    glUniform1i(pass->parallel, parallel);
    glUniform1f(pass->width, (float)(parallel ? view->radius : view->slope));
    glUniform1f(pass->slack, slot->slack);
    glUniform1i(pass->resolution, (GLint)view->resolution);
    glUniform1i(pass->first_pixel, (GLint)(slot->place * search->pixels));
    glUniform1i(pass->has_bound, slot->query->distances != NULL);
    glMultiDrawElementsBaseVertex(GL_TRIANGLES, pass->draw_counts, GL_UNSIGNED_SHORT, pass->draw_offsets,
                                  (GLsizei)slot->count, pass->draw_bases);
    return CONUS_OK;
}

static conus_status draw_round(void *user, uint32_t first, uint32_t end)
{
    const struct search *search = user;
    const struct tract_pass *pass = search->pass;
    const struct scene *scene = &pass->scenes[search->source];
    conus_status status = CONUS_OK;
    target_bind(&pass->target);
    glUseProgram(pass->program);
    glUniform1f(pass->radius, (float)scene->tractogram->radius);
    glUniform2i(pass->pixels, (GLint)first, (GLint)end);
    glBindTextureUnit(LEAF_UNIT, scene->leaves);
    glBindTextureUnit(RAY_UNIT, pass->rays);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, NEAREST_BUFFER, pass->nearest_buffer);
    glBindVertexArray(pass->vertices);
    for (size_t i = 0; i < search->slots && !status; i++) {
        status = draw_slot(search, &scene->slots[i]);
    }
    return status ? status : gl_check("pass of streamlines");
}

/* Leaves out runs behind a hit that is known by now. */
static conus_status take_hits(void *user, const void *records, uint32_t count)
{
    const struct search *search = user;
    const uint32_t(*record)[3] = (const uint32_t(*)[3])records;
    conus_status status = CONUS_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        size_t at = record[i][0];
        const struct slot *slot = search->slot_at[at / search->pixels];
        uint32_t pixel = (uint32_t)(at % search->pixels);
        float enter;
        memcpy(&enter, &record[i][2], sizeof enter);
        if (!(enter > reach_of(search->pass, slot, at, pixel))) {
            const struct tract_proposal proposal = {(size_t)(slot->query - search->queries), pixel, search->source,
                                                    record[i][1]};
            status = search->take(search->user, &proposal);
        }
    }
    return status;
}

conus_status tract_pass_render(struct tract_pass *pass, const struct tract_query *queries, size_t count,
                               tract_pass_take take, void *user)
{
    if (!count) {
        return CONUS_OK;
    }
    const size_t resolution = queries->view.resolution;
    conus_status status = CONUS_OK;
    if (pass->target.width != resolution) {
        target_finish(&pass->target);
        status = target_init(&pass->target, queries->view.resolution, queries->view.resolution, NULL, 0);
    }
    for (size_t source = 0; source < pass->scene_count && !status; source++) {
        const struct scene *scene = &pass->scenes[source];
        struct search search = {.pass = pass,
                                .source = source,
                                .queries = queries,
                                .next = queries,
                                .end = queries + count,
                                .pixels = resolution * resolution,
                                .take = take,
                                .user = user};
        status = begin_slots(&search);
        while (!status && (feed_all(&search), search.slots)) {
            size_t most = 0; /* leaves of one slot */
            for (size_t i = 0; i < search.slots; i++) {
                most = scene->slots[i].count > most ? scene->slots[i].count : most;
            }
            const struct shader_list_job job = {.binding = HIT_BUFFER,
                                                .draw = draw_round,
                                                .take = take_hits,
                                                .user = &search,
                                                .pixels = (uint32_t)search.all_pixels,
                                                .per_pixel = (uint32_t)(most * TRACT_LEAF)};
            status = shader_list_collect(&search.pass->hits, &job);
        }
    }
    return status;
}
