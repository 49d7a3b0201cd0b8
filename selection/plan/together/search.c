/* SPDX-License-Identifier: BSD-3-Clause */
/* A domain is a bit set of a list's candidates, in its order: the first bit is its best. Where the first ones of all
 * needles go together they are the answer of a node. Else, of the needles among them that conflict, the one with the
 * fewest candidates left is placed. What the first ones add up to bounds all that is below a node. Where they differ
 * too little from a combination that is listed a node is split: a needle differs from it, or it does not. */
#include "selection/plan/together/together.h"

#include "base/memory.h"
#include "base/order.h"
#include "base/status.h"

#include <string.h>

enum { WORD = 64, ROWS_BYTES = 128 << 20, NODES_A_LOOK = 1 << 8, HALVINGS = 20, PROBE_NODES = 2000, PROBES = 6 };

/** What orders combinations with one least leeway. All of it adds up over needles: a needle's number has a place of its
 * own, and the first needle's decides first. So the first ones of all domains bound the rest in the whole order. */
struct weight {
    int64_t sum, depth;
    uint64_t numbers[NEEDLE_LIMIT];
};

struct node {
    uint64_t *domains[NEEDLE_LIMIT];
    size_t at[NEEDLE_LIMIT]; /* The chosen candidate, or the first one that is left. */
    uint32_t placed;         /* bits */
};

struct search {
    const struct search_list *lists;
    size_t count;
    uint32_t among;
    size_t used[NEEDLE_LIMIT];      /* So many candidates of each list, the first ones, are looked at. */
    uint64_t ***rows[NEEDLE_LIMIT]; /* Of a candidate [count], one for each other needle: NULL until it is asked for. */
    size_t row_bytes;
    double *scratch;
    uint64_t *bits;                             /* likewise, of one part */
    size_t parts[NEEDLE_LIMIT][QUESTION_LIMIT]; /* So many of the used ones are of each part. */
    struct node **nodes;                        /* [depths] NULL until one is needed. */
    size_t depths;                              /* A needle is placed once, and split once for each that is listed. */
    size_t listed, differ;                      /* From each of so many combinations so many needles differ at least. */
    uint64_t *alike[NEEDLE_LIMIT];              /* [listed][words] Candidates that do not. */
    struct pair_test test;
    bool any_will_do, was_cancelled, is_spent;
    bool has_best;
    struct weight best;
    size_t chosen[NEEDLE_LIMIT];
    uint64_t visited, effort, limit;
    conus_progress progress;
    void *progress_user;
};

int search_item_compare(const void *a, const void *b)
{
    const struct search_item *x = a;
    const struct search_item *y = b;
    int order = (y->leeway > x->leeway) - (y->leeway < x->leeway);
    order = order ? order : (x->depth > y->depth) - (x->depth < y->depth);
    return order ? order : compare_unsigned(x->number, y->number);
}

static bool is_among(const struct search *search, size_t needle)
{
    return search->among >> needle & 1;
}

static size_t words_of(size_t count)
{
    return (count + WORD - 1) / WORD;
}

static bool has_bit(const uint64_t *bits, size_t at)
{
    return bits[at / WORD] >> at % WORD & 1;
}

static void forget_rows(struct search *search)
{
    for (size_t i = 0; i < search->count && search->row_bytes; i++) {
        for (size_t c = 0; search->rows[i] && c < search->lists[i].count; c++) {
            for (size_t k = 0; search->rows[i][c] && k < search->count; k++) {
                memory_free(search->rows[i][c][k]);
            }
            memory_free((void *)search->rows[i][c]);
            search->rows[i][c] = NULL;
        }
    }
    search->row_bytes = 0;
}

static const struct search_part *part_of(const struct search_list *list, size_t candidate)
{
    return &list->parts[list->items[candidate].part];
}

/* Whether two candidates are the same, or near each other. */
static bool are_near(const struct search_list *list, size_t candidate, const struct search_list *other,
                     size_t other_candidate, double apart)
{
    return bodies_are_near(part_of(list, candidate)->bodies, list->items[candidate].index,
                           part_of(other, other_candidate)->bodies, other->items[other_candidate].index, apart);
}

/* Sets which candidates of a needle do not differ from those of the listed combinations: from that of any needle that
 * is alike. */
static conus_status find_alike(struct search *search, size_t needle, const struct search_variety *variety)
{
    const struct search_list *list = &search->lists[needle];
    size_t words = words_of(list->count);
    uint64_t *bits = search->alike[needle] = memory_zeroed(words * variety->count, sizeof *bits);
    for (size_t n = 0; bits && n < variety->count; n++, bits += words) {
        for (size_t k = 0; k < search->count; k++) {
            const struct search_list *other = &search->lists[k];
            for (size_t c = 0; c < list->count && other->kin == list->kin; c++) {
                bool is_near = are_near(list, c, other, variety->chosen[n][k], variety->apart);
                bits[c / WORD] |= (uint64_t)is_near << c % WORD;
            }
        }
    }
    return search->alike[needle] ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status joint_create(struct search **out, const struct search_list *lists, size_t count,
                          const struct search_variety *variety, uint64_t effort, conus_progress progress,
                          void *progress_user)
{
    struct search *search = memory_zeroed(1, sizeof *search);
    if (!search) {
        return CONUS_ERROR_MEMORY;
    }
    search->lists = lists;
    search->count = count;
    search->effort = effort;
    search->progress = progress;
    search->progress_user = progress_user;
    search->listed = variety->count;
    search->differ = variety->differ;
    search->depths = count + 1 + count * variety->count;
    search->nodes = memory_zeroed(search->depths, sizeof(struct node *));
    size_t most = 0;
    conus_status status = search->nodes ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        size_t size = lists[i].count;
        most = size > most ? size : most;
        search->rows[i] = memory_zeroed(size, sizeof(uint64_t **));
        status = search->rows[i] ? CONUS_OK : CONUS_ERROR_MEMORY;
        status = status || !variety->count ? status : find_alike(search, i, variety);
    }
    search->scratch = status ? NULL : memory_raw(most, sizeof *search->scratch);
    search->bits = status ? NULL : memory_raw(words_of(most), sizeof *search->bits);
    if (!search->scratch || !search->bits) {
        joint_destroy(search);
        return CONUS_ERROR_MEMORY;
    }
    *out = search;
    return CONUS_OK;
}

void joint_destroy(struct search *search)
{
    if (!search) {
        return;
    }
    search->row_bytes = 1;
    forget_rows(search);
    for (size_t k = 0; search->nodes && k < search->depths; k++) {
        for (size_t i = 0; search->nodes[k] && i < search->count; i++) {
            memory_free(search->nodes[k]->domains[i]);
        }
        memory_free(search->nodes[k]);
    }
    for (size_t i = 0; i < search->count; i++) {
        memory_free((void *)search->rows[i]);
        memory_free(search->alike[i]);
    }
    memory_free((void *)search->nodes);
    memory_free(search->scratch);
    memory_free(search->bits);
    memory_free(search);
}

/* The node at a depth; NULL without memory. */
static struct node *node_at(struct search *search, size_t depth)
{
    struct node **node = &search->nodes[depth];
    bool whole = *node || (*node = memory_zeroed(1, sizeof **node));
    for (size_t i = 0; i < search->count && whole; i++) {
        uint64_t **domain = &(*node)->domains[i];
        whole = *domain || (*domain = memory_zeroed(words_of(search->lists[i].count), sizeof **domain));
    }
    return whole ? *node : NULL;
}

uint64_t joint_nodes(const struct search *search)
{
    return search->visited;
}

/* Whether two candidates are not for both needles at once: of a question that is answered once, or of alike needles
 * not in their order. */
static bool is_barred(const struct search *search, size_t needle, size_t candidate, size_t other,
                      size_t other_candidate)
{
    const struct search_list *list = &search->lists[needle];
    const struct search_list *to = &search->lists[other];
    const struct search_part *part = part_of(list, candidate);
    uint64_t low = needle < other ? list->items[candidate].number : to->items[other_candidate].number;
    uint64_t high = needle < other ? to->items[other_candidate].number : list->items[candidate].number;
    return (part->once && part->question == part_of(to, other_candidate)->question) ||
           (list->kin == to->kin && low >= high);
}

static void fill_row(uint64_t *bits, struct search *search, size_t needle, size_t candidate, size_t other)
{
    const struct search_list *list = &search->lists[needle];
    const struct search_list *to = &search->lists[other];
    const struct search_part *part = part_of(list, candidate);
    const size_t used = search->used[other];
    bool is_one = to->part_count == 1;
    memset(bits, 0, words_of(used) * sizeof *bits);
    for (size_t p = 0; p < to->part_count; p++) {
        pair_row(is_one ? bits : search->bits, search->scratch, part->bodies, list->items[candidate].index,
                 to->parts[p].bodies, search->parts[other][p], &search->test);
        for (size_t c = 0; c < used && !is_one; c++) {
            bool goes = to->items[c].part == p && has_bit(search->bits, to->items[c].index);
            bits[c / WORD] |= (uint64_t)goes << c % WORD;
        }
    }
    for (size_t c = 0; c < used && (part->once || list->kin == to->kin); c++) {
        bits[c / WORD] &= ~((uint64_t)is_barred(search, needle, candidate, other, c) << c % WORD);
    }
}

/* Which candidates of another needle go with one; NULL without memory. The oldest rows make room for it. */
static const uint64_t *row_of(struct search *search, size_t needle, size_t candidate, size_t other)
{
    uint64_t ***rows = &search->rows[needle][candidate];
    size_t bytes = words_of(search->used[other]) * sizeof(uint64_t);
    if ((!*rows || !(*rows)[other]) && search->row_bytes + bytes > ROWS_BYTES) {
        forget_rows(search);
    }
    if (!*rows && !(*rows = memory_zeroed(search->count, sizeof **rows))) {
        return NULL;
    }
    uint64_t **row = &(*rows)[other];
    if (!*row && (*row = memory_raw(words_of(search->used[other]), sizeof **row))) {
        search->row_bytes += bytes;
        fill_row(*row, search, needle, candidate, other);
    }
    return *row;
}

static void weigh(struct weight *out, const struct search *search, const size_t at[NEEDLE_LIMIT])
{
    *out = (struct weight){0};
    for (size_t i = 0; i < search->count; i++) {
        if (is_among(search, i)) {
            const struct search_item *item = &search->lists[i].items[at[i]];
            out->sum += item->leeway;
            out->depth += item->depth;
            out->numbers[i] = item->number;
        }
    }
}

/* Whether `a` is better. */
static bool is_better(const struct weight *a, const struct weight *b)
{
    for (size_t i = 0; a->sum == b->sum && a->depth == b->depth && i < NEEDLE_LIMIT; i++) {
        if (a->numbers[i] != b->numbers[i]) {
            return a->numbers[i] < b->numbers[i];
        }
    }
    return a->sum != b->sum ? a->sum > b->sum : a->depth < b->depth;
}

/* Counts a node. False where the search is to end. */
static bool may_go_on(struct search *search)
{
    search->visited++;
    search->is_spent = search->is_spent || search->visited > search->limit;
    if (search->visited % NODES_A_LOOK == 0 && search->progress && !search->progress(search->progress_user, 0, 0)) {
        search->was_cancelled = true;
    }
    return !search->is_spent && !search->was_cancelled;
}

static bool share_arc(const struct search *search, size_t needle, size_t candidate, size_t other,
                      size_t other_candidate)
{
    const struct search_list *list = &search->lists[needle];
    const struct search_list *to = &search->lists[other];
    return bodies_share_arc(part_of(list, candidate)->bodies, list->items[candidate].index,
                            part_of(to, other_candidate)->bodies, to->items[other_candidate].index,
                            &search->test.margins.arcs);
}

/* Whether candidates of a set of needles, each two of which fit, are on so few arcs, and so few on each. */
static bool keeps_arcs(const struct search *search, const size_t at[NEEDLE_LIMIT], uint32_t set)
{
    const struct arcs *arcs = &search->test.margins.arcs;
    size_t count = 0;
    size_t fullest = 0;
    for (size_t i = 0; i < search->count && (arcs->most || arcs->each); i++) {
        size_t own = 0;
        bool is_first = set >> i & 1;
        for (size_t k = 0; k < search->count && set >> i & 1; k++) {
            bool share = set >> k & 1 && share_arc(search, i, at[i], k, at[k]);
            own += share;
            is_first = is_first && !(share && k < i);
        }
        count += is_first;
        fullest = own > fullest ? own : fullest;
    }
    return (!arcs->most || count <= arcs->most) && (!arcs->each || fullest <= arcs->each);
}

/* Likewise of those that are placed with one candidate of another. */
static bool keeps_arcs_with(const struct search *search, const struct node *node, size_t needle, size_t candidate)
{
    size_t at[NEEDLE_LIMIT];
    memcpy(at, node->at, sizeof at);
    at[needle] = candidate;
    return keeps_arcs(search, at, node->placed | 1U << needle);
}

/* Contacts of a candidate in a cover. */
static int64_t covered_by(const struct search *search, size_t needle, size_t candidate, size_t cover)
{
    return search->lists[needle].items[candidate].covered[cover];
}

/* Whether candidates of all needles have so many contacts together in each cover. */
static bool keeps_covers(const struct search *search, const size_t at[NEEDLE_LIMIT])
{
    bool keeps = true;
    for (size_t k = 0; k < search->test.covers.count && keeps; k++) {
        int64_t sum = 0;
        for (size_t i = 0; i < search->count; i++) {
            sum += is_among(search, i) ? covered_by(search, i, at[i], k) : 0;
        }
        keeps = sum >= (int64_t)search->test.covers.least[k];
    }
    return keeps;
}

static size_t count_left(const struct search *search, const struct node *node, size_t needle)
{
    size_t count = 0;
    for (size_t w = 0; w < words_of(search->used[needle]); w++) {
        count += (size_t)__builtin_popcountll(node->domains[needle][w]);
    }
    return count;
}

/* Finds the needle to place: of those whose first candidates conflict the one with the fewest left; where only
 * limits of all needles are in the way, of all that are not placed. SIZE_MAX: the first ones are a combination. */
static conus_status find_next(size_t *next, struct search *search, const struct node *node)
{
    uint32_t conflicts = 0;
    size_t fewest = SIZE_MAX;
    *next = SIZE_MAX;
    for (size_t i = 0; i < search->count; i++) {
        for (size_t k = i + 1; k < search->count; k++) {
            uint32_t both = 1U << i | 1U << k;
            if ((search->among & both) == both && !(node->placed & both)) {
                const uint64_t *row = row_of(search, i, node->at[i], k);
                if (!row) {
                    return CONUS_ERROR_MEMORY;
                }
                conflicts |= has_bit(row, node->at[k]) ? 0 : both;
            }
        }
    }
    if (!conflicts && !(keeps_arcs(search, node->at, search->among) && keeps_covers(search, node->at))) {
        conflicts = search->among & ~node->placed;
    }
    for (size_t i = 0; i < search->count; i++) {
        size_t left = conflicts >> i & 1 ? count_left(search, node, i) : SIZE_MAX;
        if (left < fewest) {
            fewest = left;
            *next = i;
        }
    }
    return CONUS_OK;
}

static const uint64_t *alike_of(const struct search *search, size_t needle, size_t listed)
{
    return search->alike[needle] + listed * words_of(search->lists[needle].count);
}

/* The first candidate of a needle that is left and differs from a listed combination; SIZE_MAX = none. */
static size_t first_other(const struct search *search, const struct node *node, size_t needle, size_t listed)
{
    const uint64_t *alike = alike_of(search, needle, listed);
    if (node->placed >> needle & 1) {
        return has_bit(alike, node->at[needle]) ? SIZE_MAX : node->at[needle];
    }
    for (size_t w = 0; w < words_of(search->used[needle]); w++) {
        uint64_t bits = node->domains[needle][w] & ~alike[w];
        if (bits) {
            return WORD * w + (size_t)__builtin_ctzll(bits);
        }
    }
    return SIZE_MAX;
}

/* So many needles may be as in a listed combination. */
static size_t most_alike(const struct search *search)
{
    size_t count = (size_t)__builtin_popcount(search->among);
    return count > search->differ ? count - search->differ : 0;
}

/* Leaves those candidates of a needle that differ from a listed combination, or those that do not. */
static void keep(struct search *search, struct node *node, size_t needle, size_t listed, bool differs)
{
    const uint64_t *alike = alike_of(search, needle, listed);
    for (size_t w = 0; w < words_of(search->used[needle]); w++) {
        node->domains[needle][w] &= differs ? ~alike[w] : alike[w];
    }
}

/* Where all the needles that may be as in a listed combination are, the others differ from it. False where more are. */
static bool keep_variety(struct search *search, struct node *node)
{
    for (size_t n = 0; n < search->listed; n++) {
        uint32_t open = 0;
        for (size_t i = 0; i < search->count; i++) {
            open |= (uint32_t)(is_among(search, i) && first_other(search, node, i, n) < SIZE_MAX) << i;
        }
        size_t same = (size_t)__builtin_popcount(search->among & ~open);
        if (same > most_alike(search)) {
            return false;
        }
        for (size_t i = 0; i < search->count && same == most_alike(search); i++) {
            if (open >> i & 1 && !(node->placed >> i & 1)) {
                keep(search, node, i, n, true);
            }
        }
    }
    return true;
}

/* So many contacts may a candidate of each needle lack against the best one that is left, in each cover. */
struct spare {
    int64_t best[NEEDLE_LIMIT][COVER_LIMIT], lack[COVER_LIMIT];
};

/* False where even the best ones have too few. */
static bool find_spare(struct spare *out, const struct search *search, const struct node *node)
{
    bool is_enough = true;
    for (size_t k = 0; k < search->test.covers.count && is_enough; k++) {
        out->lack[k] = -(int64_t)search->test.covers.least[k];
        for (size_t i = 0; i < search->count; i++) {
            bool is_placed = node->placed >> i & 1;
            int64_t *best = &out->best[i][k];
            *best = is_placed && is_among(search, i) ? covered_by(search, i, node->at[i], k) : 0;
            for (size_t w = 0; is_among(search, i) && !is_placed && w < words_of(search->used[i]); w++) {
                for (uint64_t bits = node->domains[i][w]; bits; bits &= bits - 1) {
                    int64_t own = covered_by(search, i, WORD * w + (size_t)__builtin_ctzll(bits), k);
                    *best = own > *best ? own : *best;
                }
            }
            out->lack[k] += *best;
        }
        is_enough = out->lack[k] >= 0;
    }
    return is_enough;
}

static bool keeps_spare(const struct search *search, const struct spare *spare, size_t needle, size_t candidate)
{
    bool keeps = true;
    for (size_t k = 0; k < search->test.covers.count && keeps; k++) {
        keeps = spare->best[needle][k] - covered_by(search, needle, candidate, k) <= spare->lack[k];
    }
    return keeps;
}

/* The first candidate of a needle that is left; SIZE_MAX = none. Those before it that are on an arc too many, or one
 * too many on an arc, or have too few contacts, are left no more. */
static size_t first_left(struct search *search, struct node *node, size_t needle, const struct spare *spare)
{
    uint64_t *domain = node->domains[needle];
    for (size_t w = 0; w < words_of(search->used[needle]); w++) {
        for (; domain[w]; domain[w] &= domain[w] - 1) {
            size_t candidate = WORD * w + (size_t)__builtin_ctzll(domain[w]);
            if (keeps_arcs_with(search, node, needle, candidate) && keeps_spare(search, spare, needle, candidate)) {
                return candidate;
            }
        }
    }
    return SIZE_MAX;
}

/* Finds the first ones of a node whose domains are set. False where a needle has none. */
static bool settle(struct search *search, struct node *node)
{
    struct spare spare;
    bool is_possible = keep_variety(search, node) && find_spare(&spare, search, node);
    for (size_t i = 0; i < search->count && is_possible; i++) {
        if (is_among(search, i) && !(node->placed >> i & 1)) {
            node->at[i] = first_left(search, node, i, &spare);
            is_possible = node->at[i] < SIZE_MAX;
        }
    }
    return is_possible;
}

/* Places a candidate. *is_possible: the other needles have candidates that go with it. */
static conus_status place(struct node *out, bool *is_possible, struct search *search, const struct node *node,
                          size_t needle, size_t candidate)
{
    out->placed = node->placed | 1U << needle;
    memcpy(out->at, node->at, sizeof out->at);
    out->at[needle] = candidate;
    *is_possible = keeps_arcs(search, out->at, out->placed);
    for (size_t i = 0; i < search->count && *is_possible; i++) {
        if (!is_among(search, i) || out->placed >> i & 1) {
            continue;
        }
        const uint64_t *row = row_of(search, needle, candidate, i);
        if (!row) {
            return CONUS_ERROR_MEMORY;
        }
        uint64_t any = 0;
        for (size_t w = 0; w < words_of(search->used[i]); w++) {
            any |= out->domains[i][w] = node->domains[i][w] & row[w];
        }
        *is_possible = any;
    }
    *is_possible = *is_possible && settle(search, out);
    return CONUS_OK;
}

/* Whether the first ones of a node are worth it. */
static bool is_worth(const struct search *search, const size_t at[NEEDLE_LIMIT])
{
    struct weight weight;
    weigh(&weight, search, at);
    return !search->has_best || is_better(&weight, &search->best);
}

static bool is_over(const struct search *search)
{
    return search->is_spent || search->was_cancelled || (search->any_will_do && search->has_best);
}

static conus_status visit(struct search *search, size_t depth);

/* Visits a node with each candidate of a needle, as long as it may be better. */
static conus_status visit_each(struct search *search, size_t depth, size_t needle)
{
    const struct node *node = search->nodes[depth];
    struct node *next = node_at(search, depth + 1);
    size_t at[NEEDLE_LIMIT];
    if (!next) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(at, node->at, sizeof at);
    for (size_t w = 0; w < words_of(search->used[needle]); w++) {
        for (uint64_t bits = node->domains[needle][w]; bits; bits &= bits - 1) {
            bool is_possible = false;
            at[needle] = WORD * w + (size_t)__builtin_ctzll(bits);
            if (!is_worth(search, at)) {
                return CONUS_OK; /* nor is what follows */
            }
            conus_status status = place(next, &is_possible, search, node, needle, at[needle]);
            if (!status && is_possible && is_worth(search, next->at)) {
                status = visit(search, depth + 1);
            } else if (!status) {
                (void)may_go_on(search);
            }
            if (status || is_over(search)) {
                return status;
            }
        }
    }
    return CONUS_OK;
}

/* Whether the first ones of a node differ too little from a listed combination, and then the needle to split: the one
 * that loses least where it differs; SIZE_MAX = none can. */
static bool is_listed(size_t *listed, size_t *needle, const struct search *search, const struct node *node)
{
    for (size_t n = 0; n < search->listed; n++) {
        size_t same = 0;
        int64_t least = INT64_MAX;
        *listed = n;
        *needle = SIZE_MAX;
        for (size_t i = 0; i < search->count; i++) {
            if (is_among(search, i) && has_bit(alike_of(search, i, n), node->at[i])) {
                const struct search_item *items = search->lists[i].items;
                size_t other = first_other(search, node, i, n);
                int64_t loss = other < SIZE_MAX ? items[node->at[i]].leeway - items[other].leeway : INT64_MAX;
                *needle = loss < least ? i : *needle;
                least = loss < least ? loss : least;
                same++;
            }
        }
        if (same > most_alike(search)) {
            return true;
        }
    }
    return false;
}

/* Visits a node where a needle differs from a listed combination, and then where it does not. */
static conus_status split(struct search *search, size_t depth, size_t needle, size_t listed)
{
    const struct node *node = search->nodes[depth];
    struct node *next = node_at(search, depth + 1);
    conus_status status = next ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (int i = 0; i < 2 && !status && !is_over(search); i++) {
        next->placed = node->placed;
        memcpy(next->at, node->at, sizeof next->at);
        for (size_t k = 0; k < search->count; k++) {
            if (is_among(search, k)) {
                memcpy(next->domains[k], node->domains[k], words_of(search->used[k]) * sizeof(uint64_t));
            }
        }
        keep(search, next, needle, listed, i == 0);
        if (settle(search, next) && is_worth(search, next->at)) {
            status = visit(search, depth + 1);
        }
    }
    return status;
}

static conus_status visit(struct search *search, size_t depth)
{
    const struct node *node = search->nodes[depth];
    size_t next = SIZE_MAX;
    size_t listed = 0;
    if (!may_go_on(search)) {
        return CONUS_OK;
    }
    if (is_listed(&listed, &next, search, node)) {
        return next < SIZE_MAX ? split(search, depth, next, listed) : CONUS_OK;
    }
    conus_status status = find_next(&next, search, node);
    if (!status && next == SIZE_MAX) {
        weigh(&search->best, search, node->at);
        memcpy(search->chosen, node->at, sizeof search->chosen);
        search->has_best = true;
    }
    return status || next == SIZE_MAX ? status : visit_each(search, depth, next);
}

/* Begins a domain with what may be in what is looked for: with the least leeway, and with a sum of that of the best or
 * more. False where that is nothing. */
static bool begin_domain(struct search *search, struct node *root, size_t needle, int64_t least, int64_t all)
{
    const struct search_list *list = &search->lists[needle];
    size_t *used = &search->used[needle];
    *used = 0;
    memset(root->domains[needle], 0, words_of(list->count) * sizeof(uint64_t));
    memset(search->parts[needle], 0, sizeof search->parts[needle]);
    for (size_t c = 0; c < list->count; c++) {
        int64_t leeway = list->items[c].leeway;
        bool is_used = (!part_of(list, c)->has_leeway || leeway >= least) &&
                       (!search->has_best || all - list->items[0].leeway + leeway >= search->best.sum);
        root->domains[needle][c / WORD] |= (uint64_t)is_used << c % WORD;
        *used = is_used ? c + 1 : *used;
    }
    for (size_t c = 0; c < *used; c++) {
        search->parts[needle][list->items[c].part]++;
    }
    return *used;
}

/* Searches all that may be better than the best. */
static conus_status run(struct search *search, uint64_t nodes)
{
    struct node *root = node_at(search, 0);
    int64_t least = search->test.quantity == PAIR_LEEWAY ? search->test.least : INT64_MIN;
    int64_t all = 0;
    bool is_possible = true;
    const uint64_t left = search->effort > search->visited ? search->effort - search->visited : 0;
    search->limit = left < nodes ? search->effort : search->visited + nodes;
    search->is_spent = search->visited >= search->limit;
    forget_rows(search);
    if (!root) {
        return CONUS_ERROR_MEMORY;
    }
    root->placed = 0;
    for (size_t i = 0; i < search->count; i++) {
        bool has_items = search->lists[i].count;
        all += is_among(search, i) && has_items ? search->lists[i].items[0].leeway : 0;
        is_possible = is_possible && (has_items || !is_among(search, i));
    }
    for (size_t i = 0; i < search->count && is_possible; i++) {
        if (is_among(search, i)) {
            is_possible = begin_domain(search, root, i, least, all);
        }
    }
    is_possible = is_possible && settle(search, root);
    return is_possible && !search->is_spent && is_worth(search, root->at) ? visit(search, 0) : CONUS_OK;
}

/* The least of what a combination has. */
static int64_t least_of(const struct search *search)
{
    int64_t least = INT64_MAX;
    for (size_t i = 0; i < search->count; i++) {
        if (!is_among(search, i)) {
            continue;
        }
        const struct search_list *list = &search->lists[i];
        int64_t own = list->items[search->chosen[i]].leeway;
        bool counts = part_of(list, search->chosen[i])->has_leeway && search->test.quantity == PAIR_LEEWAY;
        least = counts && own < least ? own : least;
        for (size_t k = i + 1; k < search->count; k++) {
            if (is_among(search, k)) {
                const struct search_list *other = &search->lists[k];
                struct pair pair;
                pair_measure(&pair, part_of(list, search->chosen[i])->bodies, list->items[search->chosen[i]].index,
                             part_of(other, search->chosen[k])->bodies, other->items[search->chosen[k]].index,
                             &search->test.margins);
                int64_t value = pair_value(&pair, search->test.quantity);
                least = value < least ? value : least;
            }
        }
    }
    return least;
}

/* Looks for a combination with `least` or more, by at most so many nodes. Sets what that tells. */
static conus_status probe(struct search_answer *out, struct search *search, int64_t least, uint64_t nodes)
{
    search->test.least = least;
    search->any_will_do = true;
    search->has_best = false;
    conus_status status = run(search, nodes);
    if (!status && search->has_best) {
        out->found = true;
        out->least = least_of(search);
        out->least = out->least < out->most ? out->least : out->most; /* where nothing has a leeway */
        memcpy(out->chosen, search->chosen, sizeof out->chosen);
    } else if (!status && !search->is_spent && !search->was_cancelled) {
        out->most = least - 1;
    }
    return status ? status : search->was_cancelled ? fail(CONUS_ERROR_CANCELLED, "the search was cancelled") : CONUS_OK;
}

static bool is_open(const struct search_answer *answer, int64_t least)
{
    return answer->found ? answer->least < answer->most : answer->most >= least;
}

conus_status joint_any(struct search_answer *out, struct search *search, uint32_t among, const struct pair_test *test)
{
    search->among = among;
    search->test = *test;
    *out = (struct search_answer){.least = test->least - 1, .most = INT64_MAX};
    return probe(out, search, test->least, UINT64_MAX);
}

conus_status joint_least(struct search_answer *out, struct search *search, uint32_t among, const struct pair_test *test,
                         int64_t most)
{
    const uint64_t half = search->effort > search->visited ? (search->effort - search->visited) / 2 : 0;
    const uint64_t begun = search->visited;
    search->among = among;
    search->test = *test;
    *out = (struct search_answer){.least = test->least - 1, .most = most};
    /* Mostly the most is reached. */
    conus_status status = probe(out, search, most, half / 4);
    status = status || !is_open(out, test->least) ? status : probe(out, search, test->least, half / 4);
    int64_t high = out->most;
    for (int i = 0; i < HALVINGS && !status && out->found && out->least < high && is_open(out, test->least); i++) {
        int64_t middle = out->least + (high - out->least + 1) / 2;
        status = probe(out, search, middle, PROBE_NODES);
        high = out->least < middle ? middle - 1 : high;
    }
    /* One more than what is found, to the end. */
    bool is_stuck = false;
    while (!status && !is_stuck && is_open(out, test->least)) {
        uint64_t spent = search->visited - begun;
        int64_t least = out->found ? out->least + 1 : test->least;
        status = probe(out, search, least, spent < half ? half - spent : 0);
        is_stuck = search->is_spent;
    }
    /* Else larger ones are refuted, which gives the bound. */
    int64_t low = out->least;
    for (int i = 0; i < PROBES && !status && is_open(out, test->least) && low < out->most; i++) {
        low += (out->most - low + 1) / 2;
        int64_t before = out->most;
        status = probe(out, search, low, half / PROBES);
        low = out->most < before || out->least > low ? out->least : low;
    }
    return status;
}

conus_status joint_best(struct search_answer *found, bool *is_proven, struct search *search,
                        const struct pair_test *test)
{
    struct weight known;
    int64_t all = 0;
    search->test = *test;
    search->test.least = found->least;
    search->any_will_do = false;
    weigh(&known, search, found->chosen);
    for (size_t i = 0; i < search->count; i++) {
        all += is_among(search, i) ? search->lists[i].items[0].leeway : 0;
    }
    conus_status status = CONUS_OK;
    bool is_done = false;
    /* First with candidates that lose little against the best of their needle; twice as much until some are found. */
    for (int64_t loss = (all - known.sum) / 64 + 1; !is_done && !status; loss *= 2) {
        bool is_all = all - loss <= known.sum;
        search->best = is_all ? known : (struct weight){.sum = all - loss, .depth = INT64_MAX};
        search->has_best = true;
        memcpy(search->chosen, found->chosen, sizeof found->chosen);
        const struct weight before = search->best;
        status = run(search, UINT64_MAX);
        bool is_found = memcmp(&before, &search->best, sizeof before) != 0;
        if (!status && is_found && is_better(&search->best, &known)) {
            memcpy(found->chosen, search->chosen, sizeof found->chosen);
            known = search->best;
        }
        is_done = is_all || is_found || search->is_spent || search->was_cancelled;
    }
    *is_proven = !status && !search->is_spent && !search->was_cancelled;
    return status ? status : search->was_cancelled ? fail(CONUS_ERROR_CANCELLED, "the search was cancelled") : CONUS_OK;
}
