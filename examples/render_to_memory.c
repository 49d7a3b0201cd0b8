/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture of an atlas without a display: drawn into memory, encoded to the bytes of a PNG, and these written to a
 * file. A server would send the bytes instead. */
#include <conus/conus.h>

#include <stdio.h>

int main(int argc, char **argv)
{
    const char *path = argc > 1 ? argv[1] : "data-samples/u-shape.nii.gz";
    const char *output = argc > 2 ? argv[2] : "picture.png";
    conus_atlas *atlas = NULL;
    conus_renderer *renderer = NULL;
    conus_image *image = NULL;
    const uint8_t *bytes = NULL; /* the image's own */
    size_t size = 0;
    conus_view view = CONUS_VIEW_INIT;
    view.width = 320;
    view.height = 240;

    conus_status status = conus_atlas_load(&atlas, path, NULL);
    status = status ? status : conus_renderer_create(&renderer, atlas, NULL);
    status = status ? status : conus_render(&image, renderer, &view);
    status = status ? status : conus_image_encode(&bytes, &size, image, "png");
    FILE *file = status ? NULL : fopen(output, "wb");
    const bool written = file && fwrite(bytes, 1, size, file) == size;
    const bool closed = file && !fclose(file);
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    } else if (!written || !closed) {
        fprintf(stderr, "%s cannot be written\n", output);
        status = CONUS_ERROR_IO;
    } else {
        printf("%lu x %lu pixels, %lu bytes, drawn by %s\n", (unsigned long)conus_image_width(image),
               (unsigned long)conus_image_height(image), (unsigned long)size, conus_renderer_device(renderer));
    }
    conus_image_destroy(image);
    conus_renderer_destroy(renderer);
    conus_atlas_destroy(atlas);
    return status == CONUS_ERROR_GL ? 4 : status ? 1 : 0; /* 4: there is no OpenGL, as conus says it */
}
