/* SPDX-License-Identifier: BSD-3-Clause */
/* Which columns of a table are what: points and poses by every header, and what is refused. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "pose_checks.h"
#include "poses/pose_stream.h"
#include "poses/rows/columns.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double point[3] = {-42, -20, 50};

/* Each is the one point -42, -20, 50, called as it says. */
static void points_by_their_headers(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"name,x,y,z\nA,-42,-20,50\n", "A"},
        {"label,x,y,z\nA,-42,-20,50\n", "A"},
        {"X,Y,Z\n-42,-20,50\n", "1"},
        {"Channel,MNI_X,MNI_Y,MNI_Z\nA,-42,-20,50\n", "A"},
        {"Channel,mniX,mniY,mniZ,note\nA,-42,-20,50,n\n", "A"},
        {"Electrode,Contact,x,y,z\nA,1,-42,-20,50\n", "A1"},
        {"Electrode,Contact,x,y,z\nA,A1,-42,-20,50\n", "A1"},
        {"Electrode,Contact,x,y,z\nA,tip,-42,-20,50\n", "Atip"},
        {"X (mm)\tY (mm)\tZ (mm)\n-42\t-20\t50\n", "1"},
        {"x [cm];y [cm];z [cm]\n-4,2;-2,0;5,0\n", "1"},
        {"x2 y2 z2\n-42 -20 50\n", "1"},
        {"coord_x,coord_y,coord_z\n-42,-20,50\n", "1"},
        {"x,y,z,vox_x,vox_y,vox_z,tal_x,tal_y,tal_z\n-42,-20,50,1,2,3,4,5,6\n", "1"},
        {"x,y,z,mni_x,mni_y,mni_z\n1,2,3,-42,-20,50\n", "1"},
        {"a_x,a_y,a_z,mni_x,mni_y,mni_z\n1,2,3,-42,-20,50\n", "1"},
        {"COG X,COG Y,COG Z,Peak X,Peak Y,Peak Z\n1,2,3,-42,-20,50\n", "1"},
        {"Cluster Index\tVoxels\tMAX\tMAX X (mm)\tMAX Y (mm)\tMAX Z (mm)\tCOG X (mm)\tCOG Y (mm)\tCOG Z (mm)\n"
         "4\t812\t7.9\t-42\t-20\t50\t1\t2\t3\n",
         "4"},
        {",Cluster ID,X,Y,Z,Peak Stat\n0,7,-42,-20,50,5\n", "7"},
        {"\"x\" \"y\" \"z\"\n\"A\" -42 -20 50\n", "A"}, /* R's write.table() */
        {"R,A,S\n-42,-20,50\n", "1"},
        {"L P S\n42 20 50\n", "1"},
        {"r,L,P,S\n0.5,42,20,50\n", "1"},
        {"Z,x,y,z\n3.1,-42,-20,50\n", "1"}, /* a statistic Z */
        {"entry_x,entry_y,entry_z\n-42,-20,50\n", "1"},
        {"x,y,z,x_sd,y_sd,z_sd\n-42,-20,50,1,1,1\n", "1"},
        {"x,y,z,angle\n-42,-20,50,0\n", "1"},
        {"what,x,y,z\nA,-42,-20,50\nB,1,2,3\n", "A"},
        {"what,x,y,z\nA,-42,-20,50\nA,1,2,3\n", "1"},
        {"List of peaks\n\n# made by hand\nname x y z\n---- -- -- --\nA -42 -20 50\n", "A"},
        {"% name  x  y  z\nA  -42  -20  50\n", "A"},
        {"|name|x|y|z|\n|---|--:|--:|--:|\n|A|\xe2\x88\x92"
         "42|\xe2\x88\x92"
         "20|50|\n",
         "A"},
        {"Name;X;Y;Z;;\r\n\"A;B\";-42,0;-20,0;50,0;;\r\n;;;;;\r\n", "A;B"},
        {"-42,-20,50,hand knob\n", "hand knob"},
        {"-42 -20 50 hand knob\n", "hand knob"},
        {"hand knob -42 -20 50\n", "hand knob"},
        {"A,-42,-20,50\n", "A"},
        {"A;-42,0;-20,0;50,0\n", "A"},
        {"A\t-42\t-20\t50\t\n", "A"},
        {"-42,0 -20,0 50,0\n", "1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = NULL;
        if (pose_list_parse(&list, text_from(cases[i][0]), NULL)) {
            fail_msg("case %zu: %s", i, conus_message());
        }
        const conus_pose_row *row = conus_pose_list_row(list, 0);
        bool fits = row && !row->error && row->is_point && strcmp(row->id, cases[i][1]) == 0;
        for (int a = 0; a < 3 && fits; a++) {
            fits = fabs(row->pose.world_from_device[12 + a] - point[a]) < 1e-9;
        }
        if (!fits) {
            fail_msg("case %zu: %s", i, !row ? "no row" : row->error ? row->error : row->id);
        }
        conus_pose_list_destroy(list);
    }
}

/* Each looks from -42, -20, 50 along +y. */
static void poses_by_their_headers(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "entry_x,entry_y,entry_z,target_x,target_y,target_z\n-42,-20,50,-42,9,50\n",
        "x,y,z,target_x,target_y,target_z\n-42,-20,50,-42,9,50\n",
        "From X\tFrom Y\tFrom Z\tTo X\tTo Y\tTo Z\n-42\t-20\t50\t-42\t9\t50\n",
        "coil_x,coil_y,coil_z,dir_x,dir_y,dir_z\n-42,-20,50,0,2,0\n",
        "x_mm,y_mm,z_mm,dx,dy,dz,nx,ny,nz,roll\n-42,-20,50,0,1,0,1,0,0,7\n",
        "tx,ty,tz,qw,qx,qy,qz\n-42,-20,50,0.70710678,0.70710678,0,0\n",
        "start_x,start_y,start_z,tip_x,tip_y,tip_z,ux,uy,uz\n-42,-20,50,-42,9,50,0,0,1\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        conus_pose_list *list = pose_text_parse(text_from(texts[i]), NULL);
        const conus_pose_row *row = pose_row_of(list, 0, "1");
        assert_null(row->error);
        assert_false(row->is_point);
        assert_row_at(row, point[0], point[1], point[2]);
        assert_near(-row->pose.world_from_device[9], 1, 1e-7);
        conus_pose_list_destroy(list);
    }
}

static void what_can_be_read_in_two_ways_is_refused(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"1 -42 -20 50\n", "first three (\"x y z value\") or in the last three (\"row x y z\")"},
        {"-42 -20 50 6.3\n", "4 numbers in a line"},
        {"1,-42,-20,50\n2,-40,-20,50\n", "first three (\"x,y,z,value\") or in the last three (\"row,x,y,z\")"},
        {"seed 3 30 -19 -26\n", "(\"name x y z value\") or in the last three (\"name row x y z\")"},
        {"1 94.9 30.7 47 Fp1\n", "(\"x y z value name\") or in the last three (\"row x y z name\")"},
        {"-42,5,12,0,30,1\n", "6 numbers in a line"},
        {"-42,5, 12, 30\n", "\"-42,5, 12, 30\"; if commas are decimal, put a semicolon or a tab between numbers; else"},
        {"x;y;z\n-1,250;2,500;3,100\n", "1,250 may be 1250 or 1.25"},
        {"nx,ny,nz\n0,0,1\n", "only if nx ny nz are positions, and no direction,"},
        {"bar_x,bar_y,bar_z\n0,0,1\n", "only if bar_x bar_y bar_z are positions"},
        {"x,y,z,nx,ny,nz\n1,2,3,0,0,1\n", "nx ny nz beside x y z"},
        {"x,y,z,handle_x,handle_y,handle_z\n1,2,3,0,0,1\n", "handle_x handle_y handle_z beside x y z"},
        {"x,y,z,a_x,a_y,a_z\n1,2,3,0,0,1\n", "a_x a_y a_z beside x y z"},
        {"x,y,z,ex_x,ex_y,ex_z,ey_x,ey_y,ey_z,ez_x,ez_y,ez_z\n1,2,3,1,0,0,0,1,0,0,0,1\n",
         "header: ex ey ez beside x y z are axes of a sensor: bring"},
        {"x,y,z,arc,ring\n100,97,119,98,62\n", "column \"arc\", \"ring\" beside x y z is of a stereotactic frame"},
        {"mni_x,mni_y,mni_z,normal_x,normal_y,normal_z\n1,2,3,0,0,1\n", "normal_x normal_y normal_z beside"},
        {"x,y,z,yaw\n1,2,3,4\n", "column \"yaw\" beside x y z"},
        {"x,y,z,phi,theta\n1,2,3,4,5\n", "phi and theta are angles; those of a cap are not positions"},
        {"type,x,y,z\nentry,1,2,3\ntarget,4,5,60\n", "has an entry and a target in two rows, and no column says"},
        {"name,type,x,y,z\nA,entry,1,2,3\nA,target,4,5,60\nB,entry,1,2,3\n", "line 4: \"B\" has not one entry and one"},
        {"name,type,x,y,z\nA,entry,1,2,3\nA,target,4,5,60\nA,target,4,5,7\n", "line 2: \"A\" has not one entry"},
        {"name,type,x,y,z\nA,entry,1,2,3\nA,target,4,5,6\n", "1 of 1 axes from entry to target are shorter than 9 mm"},
        {"x,y,z,depth\n1,2,3,4\n", "depth needs a direction"},
        {"x,y,z,dx,dy,dz,angle,depth\n1,2,3,0,0,1,4,5\n",
         "\"angle\" beside depth: the opening of a cone (call it opening), or"},
        {"x,y,z,tilt_ml\n1,2,3,4\n", "only one of the columns tilt_ml and tilt_ap"},
        {"ap,ml,dv,ap_angle,ml_angle,depth\n1,2,3,4,5,6\n", "\"ap_angle\", \"ml_angle\" beside ap ml dv is not read"},
        {"ap,ml,dv,ap (deg),ml (deg),depth\n1,2,3,4,5,6\n", "\"ap (deg)\", \"ml (deg)\" beside ap ml dv is not read"},
        {"x,y,z,angle\n1,2,3,4\n", "the opening of a cone, which needs a direction"},
        {"x,y,z,near,far\n1,2,3,4,5\n", "near and far are depths along a direction"},
        {"x,y,z,ux,uy,uz\n1,2,3,4,5,6\n", "ux uy uz go with"},
        {"x1,y1,z1,x2,y2,z2\n1,2,3,4,5,6\n", "positions in x1 y1 z1 or in x2 y2 z2"},
        {"x,y,z,x,y,z\n1,2,3,4,5,6\n", "columns x y z twice: if they are the ends of an axis"},
        {"x,y,z,entry_x,entry_y,entry_z\n1,2,3,4,5,6\n", "entry_x entry_y entry_z beside x y z"},
        {"vox_x,vox_y,vox_z\n1,2,3\n", "voxels, not mm"},
        {"# mm relative to MCP\n1 2 3\n", "counted from a point that is not"},
        {"# x y z, radiological\n1 2 3\n", "exchanged: turn the sign of x if x > 0 is left, or type"},
        {"# voxel coordinates\n1 2 3\n", "voxels, not mm"},
        {"# positions are in cm\nx (mm),y (mm),z (mm)\n1,2,3\n", "1 is 10 mm by a line, 1 mm by the header"},
        {"x,y,z\n-.042,-.02,.05\n.038,.014,0\n0,.092,.002\n", "as if they were in metres"},
        {"name,x,y,z\nleft M1,42,-20,50\nright M1,-42,-20,50\nleft V1,8,-92,2\n", "sides: 2 of 2 rows called left"},
        {"name,x,y,z\n-42,M1,-20,50\n38,I,14,-4\n", "2 of 2 rows have no number where the header has x y z"},
        {"entry_x,entry_y,entry_z,target_x,target_y,target_z\n1,2,3,2,3,4\n",
         "planned and reached positions, or two spaces? Keep one of the two"},
        {"x (mm),y (cm),z (mm)\n1,2,3\n", "two units"},
        {"x,y,z,dx,dy,dz,opening (mm)\n1,2,3,0,0,1,9\n", "the unit of a length, and it is an angle"},
        {"x,y,z,dx,dy,dz,far (inch)\n1,2,3,0,0,1,9\n", "a unit that is not taken"},
        {"x_cm,y_cm,z_cm\n1,2,3\n", "is cm a unit or, as in centre of mass, a word"},
        {"ap,ml,dv\n1,2,3\n", "ap ml dv: from AC, PC or MCP, bring them to the atlas's space"},
        {"x,y,a\n1,2,3\n", "only some of the columns x y z: x y, without z"},
        {"orig_y,orig_z,a\n1,2,3\n", "only some of the columns x y z: orig_y orig_z, without x"},
        {"a,b,c\nd,e,f\n", "x y z, the positions, are missing"},
        {"name,x,y,z\nA,1,2,3\nregion,size,t\nB,4,5,6\n", "words again, as above a second table"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = NULL;
        conus_status status = pose_list_parse(&list, text_from(cases[i][0]), &(conus_pose_options){.longest = 180});
        if (status != CONUS_ERROR_DATA || !strstr(conus_message(), cases[i][1])) {
            fail_msg("case %zu: %s", i, status ? conus_message() : "read");
        }
    }
}

/* What the file says of its space: Talairach and somebody's scan are compared with the atlas, MNI 305 is moved. */
static void spaces_are_heard(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum pose_brain brain;
        double x; /* of the first row, given -42 */
    } cases[] = {
        {"# Talairach coordinates\n-42 -20 50\n", POSE_BRAIN_TALAIRACH, -42},
        {"# Talairach coordinates, brought to MNI\n-42 -20 50\n", POSE_BRAIN_MNI152, -42},
        {"# Labels of the Talairach daemon\n-42 -20 50\n", POSE_BRAIN_UNKNOWN, -42},
        {"Peaks in MNI space. Five subjects\nx,y,z\n-42,-20,50\n", POSE_BRAIN_MNI152, -42},
        {"mni_x,mni_y,mni_z\n-42,-20,50\n", POSE_BRAIN_MNI152, -42},
        {"tal_x,tal_y,tal_z\n-42,-20,50\n", POSE_BRAIN_TALAIRACH, -42},
        {"x,y,z,space\n-42,-20,50,MNI\n", POSE_BRAIN_MNI152, -42},
        {"x,y,z,space\n-42,-20,50,TAL\n", POSE_BRAIN_TALAIRACH, -42},
        {"# coordinates in native scanner space\n-42 -20 50\n", POSE_BRAIN_SUBJECT, -42},
        {"# Siemens scanner, head first\n-42 -20 50\n", POSE_BRAIN_UNKNOWN, -42},
        {"# surface RAS\n-42 -20 50\n", POSE_BRAIN_OTHER, -42},
        {"# positions on the macaque brain\n-42 -20 50\n", POSE_BRAIN_ANIMAL, -42},
        {"# MNI coordinates of the human homologue of macaque F5\n-42 -20 50\n", POSE_BRAIN_MNI152, -42},
        {"x,y,z\n-42,-20,50\nNote: coordinates are in Talairach space\n", POSE_BRAIN_TALAIRACH, -42},
        {"# positions in LPS space\n42 20 50\n", POSE_BRAIN_UNKNOWN, -42},
        {"# positions are in cm\n-4.2 -2 5\n", POSE_BRAIN_UNKNOWN, -42},
        {"# Distance (cm) of coils\n-42 -20 50\n", POSE_BRAIN_UNKNOWN, -42},
        /* 0.9975 * -42 - 0.0073 * -20 + 0.0176 * 50 - 0.0429 */
        {"# MNI305 coordinates\n-42 -20 50\n", POSE_BRAIN_MNI152, -40.9119},
        {"# of fsaverage\nx,y,z\n-42,-20,50\n", POSE_BRAIN_MNI152, -40.9119},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int any = 0; any < 2; any++) {
            conus_pose_list *list = NULL;
            if (pose_list_parse(&list, text_from(cases[i].text), &(conus_pose_options){.any_space = any})) {
                fail_msg("case %zu: %s", i, conus_message());
            }
            const conus_pose_row *row = conus_pose_list_row(list, 0);
            if (!any && (row->error || list->space.brain != cases[i].brain ||
                         fabs(row->pose.world_from_device[12] - cases[i].x) > 1e-9)) {
                fail_msg("case %zu: brain %d, x %g", i, (int)list->space.brain, row->pose.world_from_device[12]);
            }
            assert_true(!any || list->space.brain == POSE_BRAIN_UNKNOWN);
            conus_pose_list_destroy(list);
        }
    }
}

/* A file that names MNI and an animal may be in either. */
static void two_brains_are_refused(void **state)
{
    (void)state;
    static const char *const lists[] = {"# MNI; regions as in the macaque brain\n-42 -20 50\n",
                                        "# macaque coordinates\n# converted to MNI\n-42 -20 50\n",
                                        "# mouse template\nmni_x,mni_y,mni_z\n-42,-20,50\n"};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        pose_text_refuse(text_from(lists[i]), NULL, "positions are said to be in MNI, and to be in \"m");
        conus_pose_list *list = pose_text_parse(text_from(lists[i]), &(conus_pose_options){.any_space = true});
        assert_int_equal(list->space.brain, POSE_BRAIN_UNKNOWN);
        conus_pose_list_destroy(list);
    }
}

/* MNI 305 stays where the atlas is of it, and where positions are taken as they are. */
static void positions_of_mni305_stay_on_their_atlas(void **state)
{
    (void)state;
    static const char *const texts[] = {"# MNI305 coordinates\n-42 -20 50\n",
                                        "x,y,z,template\n-42,-20,50,fsaverage\n-42,-20,50,MNI305\n"};
    for (size_t i = 0; i < 2; i++) {
        conus_pose_list *list = pose_text_parse(text_from(texts[i]), &(conus_pose_options){.of_mni305 = true});
        assert_int_equal(list->space.brain, POSE_BRAIN_MNI305);
        assert_row_at(pose_row_of(list, i, i ? "2" : "1"), -42, -20, 50);
        conus_pose_list_destroy(list);
        list = pose_text_parse(text_from(texts[i]), &(conus_pose_options){.any_space = true});
        assert_row_at(pose_row_of(list, 0, "1"), -42, -20, 50);
        conus_pose_list_destroy(list);
    }
}

/* Checks that need the size of the atlas warn, or are left out where it is not known. */
static void numbers_are_judged(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"x,y,z\n-4.2,-2,5\n3.8,1.4,-.4\n-.8,-9.2,.2\n", "are they in centimetres?"},
        {"x,y,z\n66,53,61\n26,70,34\n49,17,37\n", "are they voxels, or positions in a frame?"},
        {"name,x,y,z\nleft a,-42,0,0\nright a,42,0,0\nleft b,-9,0,0\nb_L,-8,0,0\nleft c,20,0,0\n",
         "1 row lies on the other side than the name says (the first in line 6)"},
        {"name,x,y,z\nleft a,-42,0,0\nright a,42,0,0\nleft b,-9,0,0\n", NULL},
        {"x (cm),y (cm),z (cm)\n-4.2,-2,5\n3.8,1.4,-.4\n-.8,-9.2,.2\n", NULL},
        {"x,y,z\n66,53,61\n26,70,34\n", NULL},
        {"x (um),y (um),z (um)\n100,200,300\n", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = pose_text_parse(text_from(cases[i][0]), &(conus_pose_options){.longest = 180});
        bool has = cases[i][1] ? pose_has_note(list, cases[i][1]) : !conus_pose_list_note(list, 0);
        if (!has) {
            fail_msg("case %zu: %s", i, conus_pose_list_note(list, 0));
        }
        conus_pose_list_destroy(list);
    }
    pose_text_refuse(text_from("x,y,z\n-42000,0,0\n"), &(conus_pose_options){.longest = 180}, "micrometres");
    conus_pose_list *list = pose_text_parse(text_from("x,y,z\n-42000,0,0\n"), NULL);
    assert_row_at(pose_row_of(list, 0, "1"), -42000, 0, 0);
    conus_pose_list_destroy(list);
}

/* The first letter of an electrode is a side where the same one stands with the other letter, or where all begin so, of
 * both letters or three electrodes; and three contacts, all of them beyond 1/36 of the length, contradict it. */
static void electrodes_say_their_side(void **state)
{
    (void)state;
    static const struct {
        const char *names; /* one of each electrode, "" where numbers follow the letters */
        double x[4];
        int contacts;
        const char *warned;
    } cases[] = {
        {"LA/RPH",
         {30, -30},
         3,
         "2 of 2 electrodes lie on the other side than the first letter of their names says (LA, RPH)"},
        {"LPH /RPH ",
         {30, 30},
         3,
         "1 of 2 electrodes lie on the other side than the first letter of their names says (LPH)"},
        {"LAmy-/RAmy-/STN", {-30, -30, 10}, 3, "1 of 2"}, /* STN says none */
        {"LA/LB/LC", {30, 30, 30}, 3, "3 of 3"},
        {"LA/RA/LFP", {-30, 30, 20}, 3, "1 of 3"}, /* where all begin so, it is the left frontal pole */
        {"LA/RA/LFP/STN", {-30, 30, 20, 9}, 3, NULL},
        {"LA/RA", {-30, 30}, 3, NULL},
        {"LA/RA", {30, 30}, 2, NULL}, /* two contacts are no proof */
        {"LA/LB", {30, 30}, 3, NULL},
        {"LFP", {30}, 4, NULL},
        {"LFP/STN", {30, -30}, 3, NULL},
        {"LA/LB/LC/STN", {30, 30, 30, 9}, 3, NULL},
        {"Lingual/Rectus", {30, -30}, 3, NULL},
        {"L/R", {5, -5}, 3, NULL}, /* L1 is the contact of an electrode L */
        {"LA/RA", {5, -5}, 3, NULL},
        {"LA/RA", {5.01, -5}, 3, "(LA)"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024] = "name,x,y,z\n";
        struct text rest = text_from(cases[i].names);
        struct text name;
        bool more = true;
        for (size_t k = 0; text_field(&rest, '/', &more, &name); k++) {
            for (int n = 1; n <= cases[i].contacts; n++) {
                size_t used = strlen(text);
                snprintf(text + used, sizeof text - used, "%.*s%d,%g,-20,-15\n", (int)name.size, name.data, n,
                         cases[i].x[k]);
            }
        }
        conus_pose_list *list = pose_text_parse(text_from(text), &(conus_pose_options){.longest = 180});
        bool has = pose_has_note(list, cases[i].warned ? cases[i].warned : "other side");
        if (has != (cases[i].warned != NULL)) {
            fail_msg("case %zu: %s", i, text);
        }
        conus_pose_list_destroy(list);
        char words[] = ",sides=anyway";
        list = pose_text_parse(text_from(text), &(conus_pose_options){.longest = 180, .columns = words + 1});
        assert_false(pose_has_note(list, "other side"));
        conus_pose_list_destroy(list);
    }
}

/* The user's word beats what is found, and what is said against it. */
static void columns_are_named_by_the_user(void **state)
{
    (void)state;
    static const char text[] = "who,a,b,c,nx,ny,nz\nleft M1,4.2,2,-5,0,0,1\nleft V1,1,2,3,0,0,1\nleft I,1,2,3,0,0,1\n";
    const conus_pose_options options = {.columns = "x=a,y=b,z=C,name=who,unit=cm,sides=anyway", .longest = 180};
    conus_pose_list *list = pose_text_parse(text_from(text), &options);
    assert_row_at(pose_row_of(list, 0, "left M1"), 42, 20, -50);
    conus_pose_list_destroy(list);
    static const char *const bad[][2] = {
        {"x=a,y=b", "only some of x=, y= and z="},
        {"x=a,y=b,z=d", "column \"d\" is not there"},
        {"unit=inch", "unit: found \"inch\", allowed are mm, um, cm and m"},
        {"depth=inch", "depth: found \"inch\", allowed are mm, um, cm and m"},
        {"radius=um", "a unit of radius, and no such column"},
        {"tilt_ap=d", "column \"d\" is not there"},
        {"sides=no", "sides: found \"no\", allowed is anyway"},
        {"w=a", "allowed are x, y, z, name, place, unit, sides, tilt_ml, tilt_ap, depth, radius"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_true(pose_list_parse(&list, text_from(text), &(conus_pose_options){.columns = bad[i][0]}) != CONUS_OK);
        assert_non_null(strstr(conus_message(), bad[i][1]));
    }
    static const char *const lost[][3] = {
        /* words that no column takes */
        {"1 2 3\n2 3 4\n", "tilt_ap=z", "no header, so that no column is called \"z\""},
        {"1 2 3\n2 3 4\n", "depth=um", "no header, so that no column is called \"depth\""},
        {"name\tx\ty\tz\nA1\t1\t2\t3\n", "depth=um", "depth= and radius= are for tables, as --poses-format table"},
        {"name\tx\ty\tz\nA1\t1\t2\t3\n", "tilt_ml=x", "tilt_ml=, tilt_ap=, depth= and radius= are for tables"},
        {"# Markups fiducial file version = 5.2\n# CoordinateSystem = LPS\n# columns = id,x,y,z\n1,1,2,3\n", "depth=um",
         "\"depth=um\" is for tables, points and electrodes (BIDS), and not for markups"},
        {"# Markups fiducial file version = 5.2\n# CoordinateSystem = LPS\n# columns = id,x,y,z\n1,1,2,3\n",
         "tilt_ap=x", "\"tilt_ap=x\" is for tables, points and electrodes (BIDS), and not for markups"},
        {"x,y,z\n1,2,3\n", "tilt_ap=x", "column \"x\" is called a tilt, but it is one of a position or direction"},
        {"x,y,z,tilt_ap\n1,2,3,4\n", "tilt_ap=x", "column \"x\" is called a tilt, but it is one of a position"},
        {"x,y,z,a,b,c\n1,2,3,4,5,6\n", "x=a,y=b,z=c,tilt_ap=a", "column \"a\" is called a tilt, but it is one of"},
        {"x,y,z,a\n1,2,3,4\n", "tilt_ml=a,tilt_ap=a", "column \"a\" is called a tilt, but it is one of"}};
    for (size_t i = 0; i < sizeof lost / sizeof lost[0]; i++) {
        assert_true(pose_list_parse(&list, text_from(lost[i][0]), &(conus_pose_options){.columns = lost[i][1]}) !=
                    CONUS_OK);
        assert_non_null(strstr(conus_message(), lost[i][2]));
    }
    static const char leaning[] = "x,y,z,tilt_ap,lean (rad)\n30,-20,50,0,0.7853981633974483\n";
    list = pose_text_parse(text_from(leaning), &(conus_pose_options){.columns = "tilt_ap=lean (rad)"});
    assert_near(pose_row_of(list, 0, "1")->pose.world_from_device[9], -sqrt(0.5), 1e-12);
    conus_pose_list_destroy(list);
    assert_true(pose_list_parse(&list, text_from("who,x,y,z\nM1,4,2,-5\n"),
                                &(conus_pose_options){.columns = "place=who"}) == CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "names of places are read from tables and lists where an atlas is"));
    assert_int_equal(conus_pose_path_length("a b.csv,x=1,y=2"), 7);
    assert_int_equal(conus_pose_path_length("a,b.csv"), 7);
    char path[4096];
    snprintf(path, sizeof path, "%s", test_scratch("a,x=1.csv"));
    assert_ok(file_write(path, text, sizeof text - 1));
    assert_int_equal(conus_pose_path_length(path), strlen(path)); /* a file is called so */
    snprintf(path, sizeof path, "%s", test_scratch("a.csv"));
    assert_ok(file_write(path, text, sizeof text - 1));
    const size_t length = strlen(path);
    snprintf(path + length, sizeof path - length, ",colour=3"); /* which is no key */
    assert_int_equal(conus_pose_path_length(path), length);
}

/* A word that changes nothing is refused. */
static void words_without_use_are_refused(void **state)
{
    (void)state;
    static const char electrodes[] = "name\tx\ty\tz\nA\t1\t2\t3\n";
    static const char *const bad[][3] = {
        {"1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n", "unit=cm", "and not for matrix"},
        {"1 2 3 A\n", "name=who", "no header"},
        {"1 2 3\n", "x=a,y=b,z=c", "no header"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        pose_text_refuse(text_from(bad[i][0]), &(conus_pose_options){.columns = bad[i][1]}, bad[i][2]);
    }
    conus_pose_list *list = NULL;
    assert_fails(
        conus_pose_list_load(&list, pose_sample("fiducials.fcsv"), &(conus_pose_options){.columns = "unit=um"}),
        CONUS_ERROR_DATA);
    static const char *const good[] = {"1 2 3 A\n", "name,x,y,z\nA,1,2,3\n", electrodes};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        list = pose_text_parse(text_from(good[i]), &(conus_pose_options){.columns = "unit=cm"});
        assert_row_at(pose_row_of(list, 0, "A"), 10, 20, 30);
        conus_pose_list_destroy(list);
    }
}

/* Tilts lead the tip lateral and anterior; IBL's angles are those from the tip to the top; a depth alone is straight
 * down from bregma. Axes end at a depth and at a target, but not where they only point. */
static void angles_and_ends(void **state)
{
    (void)state;
    const conus_frame bregma = {.space = CONUS_SPACE_BREGMA,
                                .world_from_space = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                .bregma = {5400, 332, 5739}};
    static const struct {
        const char *text;
        bool from_bregma;
        double at[3], way[3], end; /* world; way of any length, end NaN: none */
    } cases[] = {
        {"x,y,z,tilt_ml,tilt_ap\n30,-20,50,45,0\n", false, {30, -20, 50}, {1, 0, -1}, NAN},
        {"x,y,z,tilt_ml,tilt_ap,depth\n-30,-20,50,45,0,7\n", false, {-30, -20, 50}, {-1, 0, -1}, 7},
        {"x,y,z,tilt_ml,tilt_ap\n-30,-20,50,0,45\n", false, {-30, -20, 50}, {0, 1, -1}, NAN},
        {"AP,ML,DV,tilt_ml,tilt_ap\n-2,-1,-.1,45,0\n", true, {-1, -2, -.1}, {-1, 0, -1}, NAN},
        {"probe,AP,ML,DV,angle,depth\nA,-2.4,1.6,-.1,0,3.3\n", true, {1.6, -2.4, -.1}, {0, 0, -1}, 3.3},
        {"x (um),y (um),z (um),depth (um),theta,phi\n1600,-2400,-100,3300,90,180\n",
         true,
         {1.6, -2.4, -.1},
         {1, 0, 0},
         3.3},
        {"entry_x,entry_y,entry_z,target_x,target_y,target_z\n0,0,0,3,4,0\n", false, {0, 0, 0}, {3, 4, 0}, 5},
        {"x,y,z,tx,ty,tz\n0,0,0,3,4,0\n", false, {0, 0, 0}, {3, 4, 0}, NAN},
        {"x,y,z,dx,dy,dz,depth (cm)\n0,0,0,3,4,0,2\n", false, {0, 0, 0}, {3, 4, 0}, 20},
        {"x\ty\tz\tdx\tdy\tdz\tdepth (cm)\nA\t0\t0\t0\t3\t4\t0\t2\n", false, {0, 0, 0}, {3, 4, 0}, 20}, /* R */
        {"depth (cm)\tx\ty\tz\tdx\tdy\tdz\tangle\nA\t2\t0\t0\t0\t3\t4\t0\t0\n", false, {0, 0, 0}, {3, 4, 0}, 20},
        {"x,y,z,dx,dy,dz,depth_cm\n0,0,0,3,4,0,2\n", false, {0, 0, 0}, {3, 4, 0}, 20},
        {"x,y,z,dx,dy,dz,near (cm),far_cm\n0,0,0,3,4,0,0,2\n", false, {0, 0, 0}, {3, 4, 0}, 20},
        {"x,y,z,tilt_ml (rad),tilt_ap (rad)\n30,-20,50,0.7853981633974483,0\n", false, {30, -20, 50}, {1, 0, -1}, NAN},
    };
    static const char *const angles[] = {"angle,0.5729577951308232", "angle [\xc2\xb0],0.5729577951308232",
                                         "angle_degrees,0.5729577951308232", "angle (rad),0.01"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_pose_list *list = pose_text_parse(text_from(cases[i].text),
                                                &(conus_pose_options){.frame = cases[i].from_bregma ? &bregma : NULL});
        const conus_pose_row *row = conus_pose_list_row(list, 0);
        double way[3];
        bool has_phi = strstr(cases[i].text, "phi");
        assert_null(row->error);
        assert_int_equal(pose_has_note(list, "theta 0 is straight down; x y z are ML, AP, DV"), has_phi);
        assert_row_at(row, cases[i].at[0], cases[i].at[1], cases[i].at[2]);
        assert_true(vec3_normalise(way, cases[i].way));
        assert_row_along(row, way[0], way[1], way[2]);
        bool ends = isnan(cases[i].end) ? isnan(row->range[1]) : fabs(row->range[1] - cases[i].end) < 1e-9;
        if (!ends || (!isnan(cases[i].end) && row->range[0] != 0)) {
            fail_msg("case %zu: %g to %g", i, row->range[0], row->range[1]);
        }
        conus_pose_list_destroy(list);
    }
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        char text[128];
        const char *comma = strchr(angles[i], ',');
        snprintf(text, sizeof text, "x,y,z,dx,dy,dz,%.*s\n0,0,0,3,4,0%s\n", (int)(comma - angles[i]), angles[i], comma);
        conus_pose_list *list = pose_text_parse(text_from(text), NULL);
        assert_true(fabs(conus_pose_list_row(list, 0)->angle - degrees_from_radians(0.01)) < 1e-12);
        conus_pose_list_destroy(list);
    }
}

/* Whatever calls the target, the range is that of the options. */
static void ranges_end_at_targets(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "x,y,z,tx,ty,tz\n0,0,0,3,4,0\n",
        "x,y,z,target_x,target_y,target_z\n0,0,0,3,4,0\n",
        "entry_x,entry_y,entry_z,tip_x,tip_y,tip_z\n0,0,0,3,4,0\n",
        "(0, 0, 0) -> (3, 4, 0)\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        const conus_pose_options options = {.to_target = true, .near = 2, .beyond = 1};
        conus_pose_list *list = pose_text_parse(text_from(texts[i]), &options);
        const conus_pose_row *row = conus_pose_list_row(list, 0);
        if (row->error || row->range[0] != 2 || row->range[1] != 6) {
            fail_msg("case %zu: %s, %g to %g", i, row->error ? row->error : "", row->range[0], row->range[1]);
        }
        conus_pose_list_destroy(list);
    }
}

/* Rows that are none, and lines of words, are passed over with a note each, and are not counted. */
static void lines_that_are_no_rows(void **state)
{
    (void)state;
    static const char text[] = "name,x,y,z\nA,1,2,3\nB,n/a,n/a,n/a\n# a comment, 1, 2, 3\nname,x,y,z\nC,4,5\nclosing\n"
                               "D,n/a,5,6\nMean,1,2,3\nE,7,8,9\n";
    conus_pose_list *list = pose_text_parse(text_from(text), NULL);
    assert_int_equal(conus_pose_list_count(list), 4);
    assert_row_at(pose_row_of(list, 0, "A"), 1, 2, 3);
    assert_row_fails(list, 1, "C", "3 fields, the header has 4");
    assert_row_fails(list, 2, "D", "column x: \"n/a\"");
    assert_row_at(pose_row_of(list, 3, "E"), 7, 8, 9);
    assert_true(pose_has_note(list, "1 rows without coordinates (n/a) passed over, the first in line 3"));
    assert_true(pose_has_note(list, "1 lines that are the header again passed over, the first in line 5"));
    assert_true(pose_has_note(list, "1 lines without a number passed over, the first in line 7"));
    assert_true(pose_has_note(list, "1 rows called Mean, SD or Total passed over, the first in line 9"));
    conus_pose_list_destroy(list);
    /* 999 in all three is no position, as pandas writes it, too; in two of them it is one */
    list = pose_text_parse(text_from("x,y,z\n1,2,3\n999.0,-999.00,9999\n999,5,999\n"), NULL);
    assert_int_equal(conus_pose_list_count(list), 2);
    assert_row_at(pose_row_of(list, 1, "2"), 999, 5, 999);
    conus_pose_list_destroy(list);
    /* what stands for a missing value beside one that is missing is no coordinate in micrometres */
    list = pose_text_parse(text_from("x,y,z\n-40,-20,50\n9999,-20,n/a\n"), &(conus_pose_options){.longest = 180});
    assert_int_equal(conus_pose_list_count(list), 2);
    assert_row_at(pose_row_of(list, 0, "1"), -40, -20, 50);
    assert_row_fails(list, 1, "2", "column z: \"n/a\"");
    conus_pose_list_destroy(list);
    conus_pose_stream *stream = NULL;
    uint64_t count = 0;
    assert_ok(pose_stream_parse(&stream, text_from(text), NULL));
    assert_true(conus_pose_stream_facts(stream).has_points);
    assert_ok(conus_pose_stream_count(&count, stream));
    assert_int_equal(count, 4);
    conus_pose_stream_destroy(stream);
}

/* A text that is cut off is refused, or gives the first of its rows, the last one perhaps with an error. */
static void every_prefix_is_refused_or_shorter(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "Peaks\n# of 2\nName;MNI_X (mm);MNI_Y (mm);MNI_Z "
        "(mm);Tal_X\n\"a;b\";-1,5;2,5;3,25;7\n\nb;n/a;n/a;n/a\nc;1;2;3;4\n",
        "\xff\xfeN\0\t\0x\0\t\0y\0\t\0z\0\r\0\n\0\xfc\0\t\0\x12\x22\x31\0\t\0\x32\0\t\0\x33\0\n\0",
        "|name|x|y|z|tx|ty|tz|\n|---|\n|a|1|2|3|4|5|6|\n"};
    static const size_t sizes[] = {0, 38, 0};
    for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++) {
        size_t whole = sizes[k] ? sizes[k] : strlen(texts[k]);
        for (size_t size = 0; size <= whole; size++) {
            conus_pose_list *list = NULL;
            char *exact = malloc(size + !size); /* so that a sanitizer notices one byte too many */
            memcpy(exact, texts[k], size);
            (void)!pose_list_parse(&list, (struct text){exact, size}, NULL);
            assert_true(conus_pose_list_count(list) <= 2);
            conus_pose_list_destroy(list);
            free(exact);
        }
    }
}

/* As Excel writes "Unicode text", and Windows-1252. */
static void other_encodings_are_read(void **state)
{
    (void)state;
    static const char wide[] = "\xff\xfeN\0a\0m\0e\0\t\0x\0\t\0y\0\t\0z\0\r\0\n\0"
                               "\xfc\0\x3d\xd8\0\xde\t\0\x12\x22\x31\0\t\0\x32\0\t\0\x33\0\r\0\n";
    conus_pose_list *list = NULL;
    assert_ok(pose_list_parse(&list, (struct text){wide, sizeof wide}, NULL));
    assert_row_at(pose_row_of(list, 0, "\xc3\xbc\xf0\x9f\x98\x80"), -1, 2, 3);
    conus_pose_list_destroy(list);
    list = pose_text_parse(text_from("Name;X;Y;Z\nGr\xf6\xdf"
                                     "e;1;\x96"
                                     "2;3\xa0\n"),
                           NULL);
    assert_row_at(pose_row_of(list, 0,
                              "Gr\xc3\xb6\xc3\x9f"
                              "e"),
                  1, -2, 3);
    assert_true(pose_has_note(list, "read as Windows-1252"));
    conus_pose_list_destroy(list);
}

static conus_status parse_table(void *data)
{
    conus_pose_list *list = NULL;
    conus_status status = pose_list_parse(&list, text_from(data), NULL);
    conus_pose_list_destroy(list);
    return status;
}

static const char *const keep[] = {"GROUP", "note"};

static conus_status parse_kept(void *text)
{
    conus_pose_list *list = NULL;
    const conus_pose_options options = {.keep = keep, .keep_count = 2};
    conus_status status = pose_list_parse(&list, text_from(text), &options);
    if (!status) {
        static const char *const wanted[][2] = {{"a", "x \"y\", z"}, {"", ""}, {"c", "d"}};
        assert_int_equal(conus_pose_list_count(list), 3);
        for (size_t i = 0; i < 3; i++) {
            const conus_pose_row *row = conus_pose_list_row(list, i);
            assert_int_equal(row->error != NULL, i == 2);
            assert_string_equal(row->kept[0], wanted[i][0]);
            assert_string_equal(row->kept[1], wanted[i][1]);
        }
    }
    conus_pose_list_destroy(list);
    return status;
}

static void texts_of_columns_are_kept(void **state)
{
    (void)state;
    static char text[] = "name,group,x,y,z,note\nA,a,1,2,3,\"x \"\"y\"\", z\"\nB,,1,2,4\nC,c,1,q,5,d\n";
    test_every_allocation(parse_kept, text);
    conus_pose_list *list = NULL;
    const conus_pose_options options = {.keep = keep, .keep_count = 2};
    assert_fails(pose_list_parse(&list, text_from("name,group,x,y,z\nA,a,1,2,3\n"), &options), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "no column is called \"note\""));
    assert_fails(pose_list_parse(&list, text_from("1 2 3\n"), &options), CONUS_ERROR_DATA);
    assert_fails(pose_list_parse(&list, text_from(text), &(conus_pose_options){.keep = keep, .keep_count = 65}),
                 CONUS_ERROR_ARGUMENT);
}

/* Only a second line that calls the cell coordinates is one more header. */
static void a_name_in_place_of_a_cell_of_numbers_is_a_bad_row(void **state)
{
    (void)state;
    conus_pose_list *list = pose_text_parse(text_from("name\tcoords\nA\tCz\nB\t-42 -20 50\n"), NULL);
    assert_int_equal(list->count, 2);
    assert_string_equal(list->rows[0].error, "no cell of three numbers");
    assert_row_at(pose_row_of(list, 1, "B"), -42, -20, 50);
    conus_pose_list_destroy(list);
    list = pose_text_parse(text_from("set\tpeak\np\tx,y,z {mm}\nA\t-42 -20 50\n"), NULL);
    assert_int_equal(list->count, 1);
    conus_pose_list_destroy(list);
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    char good[] = "Electrode,Contact,MNI_X,MNI_Y,MNI_Z,note\nGr\xf6\xdf"
                  "e,1,1,2,3,n\nB,2,n/a,n/a,n/a,n\nwords\n";
    char bad[] = "x,y,z,nx,ny,nz,yaw,x\n1,2,3,4,5,6,7,8\n";
    char wide[] = "\xfe\xff";
    test_every_allocation(parse_table, good);
    assert_int_equal(parse_table(bad), CONUS_ERROR_DATA);
    assert_int_equal(parse_table(wide), CONUS_ERROR_DATA);
}

TEST_GROUP(columns)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_by_their_headers),
        cmocka_unit_test(poses_by_their_headers),
        cmocka_unit_test(what_can_be_read_in_two_ways_is_refused),
        cmocka_unit_test(spaces_are_heard),
        cmocka_unit_test(two_brains_are_refused),
        cmocka_unit_test(positions_of_mni305_stay_on_their_atlas),
        cmocka_unit_test(numbers_are_judged),
        cmocka_unit_test(electrodes_say_their_side),
        cmocka_unit_test(columns_are_named_by_the_user),
        cmocka_unit_test(words_without_use_are_refused),
        cmocka_unit_test(angles_and_ends),
        cmocka_unit_test(ranges_end_at_targets),
        cmocka_unit_test(lines_that_are_no_rows),
        cmocka_unit_test(every_prefix_is_refused_or_shorter),
        cmocka_unit_test(other_encodings_are_read),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(texts_of_columns_are_kept),
        cmocka_unit_test(a_name_in_place_of_a_cell_of_numbers_is_a_bad_row),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
