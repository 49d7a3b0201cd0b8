% SPDX-License-Identifier: BSD-3-Clause
% Rows, errors, files and words of conus.m, in a folder with nested.nii.gz and the program's own rows, wanted.tsv.
% scripts/hosts octave runs it.
rows = conus('query', 'nested.nii.gz', '--origin', [0 0 90.5], '--toward', [0 0 0], '--angle', 20, '--quiet');
wanted = strsplit(strtrim(fileread('wanted.tsv')), "\n");
head = strsplit(wanted{1}, "\t");
assert(numel(rows.rank), numel(wanted) - 1)
assert(fieldnames(rows), head')
for i = 2:numel(wanted)
  cells = strsplit(wanted{i}, "\t", 'CollapseDelimiters', false);
  assert(rows.name{i - 1}, cells{strcmp(head, 'name')})
  assert(rows.share(i - 1), str2double(cells{strcmp(head, 'share')}))
end
failed = '';
try, conus('query', 'nested.nii.gz', '--origin', [0 0]); catch e, failed = e.identifier; end
assert(failed, 'conus:usage')
try, conus('query', 'no such ''x $HOME', '--point', [0 0 0]); catch e, failed = e.identifier; end
assert(failed, 'conus:data')
assert(strncmp(e.message, 'no such ''x $HOME: ', 18), e.message)
assert(ischar(conus('info', 'nested.nii.gz')))
conus('query', 'nested.nii.gz', '--point', [0 0 0], '-o', 'a file.tsv', '--quiet');
assert(exist('a file.tsv', 'file') > 0)
assert(~isempty(strfind(conus('cite', 'a file.tsv'), 'conus')))
[rows, notes] = conus('overlap', 'nested.nii.gz', 'nested.nii.gz', '--threshold', 1);
assert(isnumeric(rows.volume_mm3) && ischar(notes))
function make(name, text)
  file = fopen(name, 'w'); fprintf(file, '%s\n', '#!/bin/sh', text); fclose(file);
  system(['chmod +x ', name]);
  setenv('CONUS', fullfile(pwd, name));
end
% A program that is killed, with a note and rows, and one that is not there.
make('killed', 'echo rows; echo a note >&2; kill -9 $$');
try, conus('info', 'nested.nii.gz'); catch e, failed = e.identifier; end
assert(failed, 'conus:failed')
clear conus % which knows the commands of the first program
failed = '';
try, conus('info', 'nested.nii.gz'); catch e, failed = e.identifier; end
assert(failed, 'conus:failed')
setenv('CONUS', fullfile(pwd, 'none'));
failed = '';
try, conus('info', 'nested.nii.gz'); catch e, failed = e.identifier; end
assert(failed, 'conus:failed')
assert(~isempty(strfind(e.message, 'none')), e.message)
disp('octave: rows, errors, files and words are those of the program')
