# SPDX-License-Identifier: BSD-3-Clause
# The function of docs/hosts.md, which stands in conus.R here, in a folder with nested.nii.gz and wanted.tsv. scripts/hosts r runs it.
source("conus.R")
rows <- conus_rows("query", "nested.nii.gz", "--origin", c(0, 0, 90.5), "--toward", c(0, 0, 0), "--angle", 20, "--quiet")
wanted <- read.delim("wanted.tsv", na.strings = "n/a", check.names = FALSE)
stopifnot(identical(rows, wanted), nrow(rows) > 1, is.numeric(rows$share))
failed <- tryCatch(conus_rows("query", "no such 'x", "--point", c(0, 0, 0)), error = function(e) conditionMessage(e))
stopifnot(is.character(failed))
cat("r: rows are those of the program, and a failure stops\n")
