function [rows, notes] = conus(varargin)
% CONUS  The command line of conus; numbers may stand for their texts. Rows come as a table (Octave: a struct of columns).
%
%   rows = conus('query', 'aal', '--origin', [-90 20 20], '--toward', [0 -10 10], '--angle', 20)
%   rows = conus('overlap', 'aal', 'lesion.nii.gz')
%   text = conus('cite', 'rows.tsv')
%
% Rows come of a command that answers, where neither -o nor --format is given, "n/a" as NaN; else its text. An error has
% the identifier conus:usage, conus:data or conus:gl and conus's message; where conus is not there, or did not end by
% itself, conus:failed. Notes and warnings are printed, or the second output. The program is $CONUS, or conus in the path.
% SPDX-License-Identifier: BSD-3-Clause
  words = cellfun(@in_words, varargin, 'UniformOutput', false);
  given = @(name) any(strncmp(words, name, numel(name)));
  has_rows = nargin && answers(words{1}) && ~given('-o') && ~given('--output') && ~given('--format');
  if has_rows, words{end + 1} = '--format=tsv'; end
  [code, rows, notes] = run(words);
  if code ~= 0 && code ~= 1, refuse(code, notes); end
  if nargout < 2 && ~isempty(notes), fprintf(2, '%s\n', notes); end
  if has_rows, rows = columns(rows); end
end

function is = answers(command)
% Whether the command has rows, as the program says of itself.
  persistent names;
  if isempty(names)
    [code, text, notes] = run({'help', '--json'});
    if code ~= 0, refuse(code, notes); end
    commands = jsondecode(text).commands;
    if ~iscell(commands), commands = num2cell(commands); end
    names = cellfun(@(c) c.name, commands(cellfun(@(c) c.answers, commands)), 'UniformOutput', false);
  end
  is = any(strcmp(names, command));
end

function refuse(code, notes)
% The error of a program that has failed; a negative code, or one above 4, is none of conus.
  kinds = {'data', 'usage', 'data', 'gl'};
  kind = 'failed';
  if code >= 1 && code <= 4, kind = kinds{code}; end
  if isempty(notes), notes = sprintf('conus ended with %d', code); end
  error(['conus:', kind], '%s', regexprep(notes, '^conus: ', ''));
end

function [code, text, notes] = run(words)
  program = getenv('CONUS');
  if isempty(program), program = 'conus'; end
  out = tempname(); err = tempname();
  clean = onCleanup(@() remove(out, err));
  line = [strjoin(cellfun(@quoted, [{program}, words], 'UniformOutput', false), ' '), ' >', quoted(out), ' 2>', quoted(err)];
  if isunix() && ~exist('OCTAVE_VERSION', 'builtin')
    line = ['env -u LD_LIBRARY_PATH -u DYLD_LIBRARY_PATH ', line]; % MATLAB's own libraries are not conus's
  elseif ispc()
    line = ['"', line, '"']; % cmd takes the outer ones off
  end
  code = system(line);
  text = fileread(out);
  notes = strtrim(fileread(err));
end

function text = in_words(value)
  if ischar(value), text = value; return, end
  if isa(value, 'string'), text = char(value); return, end
  text = strjoin(arrayfun(@(x) sprintf('%.17g', x), double(value(:)'), 'UniformOutput', false), ',');
end

function text = quoted(word)
  if ispc(), text = ['"', strrep(word, '"', '""'), '"']; else, text = ['''', strrep(word, '''', '''\'''''), '''']; end
end

function remove(varargin)
  for i = 1:nargin, if exist(varargin{i}, 'file'), delete(varargin{i}); end, end
end

function out = columns(text)
  lines = regexp(strtrim(text), '\r?\n', 'split');
  head = regexp(lines{1}, '\t', 'split');
  cells = cellfun(@(l) regexp(l, '\t', 'split'), lines(2:end)', 'UniformOutput', false);
  cells = vertcat(cell(0, numel(head)), cells{:});
  for i = 1:numel(head)
    numbers = str2double(cells(:, i));
    if all(~isnan(numbers) | strcmp(cells(:, i), 'n/a')), out.(head{i}) = numbers; else, out.(head{i}) = cells(:, i); end
  end
  if exist('struct2table', 'file'), out = struct2table(out); end
end
