# The rules of scripts/style.
function report(line, what) {
    print FILENAME ":" line ": " what
    findings++
}
# Comments and strings leave, so that a word in them is no call.
function code(text,    at) {
    if (in_comment) {
        at = index(text, "*/")
        if (!at)
            return ""
        text = substr(text, at + 2)
        in_comment = 0
    }
    gsub(/\\./, "", text)
    gsub(/"[^"]*"/, "\"\"", text)
    gsub(/\/\*([^*]|\*+[^*\/])*\*+\//, " ", text)
    sub(/\/\/.*/, "", text)
    at = index(text, "/*")
    if (at) {
        in_comment = 1
        text = substr(text, 1, at - 1)
    }
    return text
}
function calls(text, names) {
    return text ~ "(^|[^A-Za-z0-9_>.])(" names ")[ ]*\\("
}
FNR == 1 {
    in_comment = 0
    library = FILENAME ~ /^(base|sources|atlas|poses|loaders|render|selection|pack)\//
}
{
    text = code($0)
}
FNR == 2 && FILENAME ~ /[.](c|cpp)$/ && FILENAME !~ /^examples\// && !/^\/[*\/]/ {
    report(FNR, "the file does not open with a comment that says what it is")
}
/[-=][-=][-=][-=][-=]( \*\/)?$/ {
    report(FNR, "a banner")
}
calls(text, "strcpy|strcat|sprintf|vsprintf|gets|atoi|atol|atof|strtok|scanf|sscanf|fscanf|alloca|rand|srand") {
    report(FNR, "banned function:" $0)
}
FILENAME !~ /^tests\// && calls(text, "qsort|qsort_r") {
    report(FNR, "not stable everywhere; base/order.h is:" $0)
}
# C promises "not 0" of these, no number.
text ~ /([-+*] *(isnan|isinf|isfinite|signbit) *\(|(isnan|isinf|isfinite|signbit) *\([^()]*\) *[-+*])/ {
    report(FNR, "arithmetic with a truth:" $0)
}
library && calls(text, "exit|_exit|abort|printf|fprintf|vprintf|vfprintf|puts|putchar|perror|system|setlocale") {
    report(FNR, "not in the library:" $0)
}
library && FILENAME !~ /^base\/(memory|order|text_gnu|system\/system_[a-z]+|child\/process_[a-z]+)[.]c$/ &&
    calls(text, "malloc|calloc|realloc|reallocarray|aligned_alloc|posix_memalign|free|strdup|strndup|asprintf") {
    report(FNR, "allocation goes through base/memory.h:" $0)
}
library && FILENAME !~ /^base\/job\// && calls(text, "job_took") {
    report(FNR, "an error comes to a job by JOB_CALL() or job_need():" $0)
}
calls(text, "GIVE") && text !~ /GIVE\(status,/ {
    report(FNR, "GIVE() reads its status after the thing's end, so it is a variable:" $0)
}
END {
    exit findings > 0
}