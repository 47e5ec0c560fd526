function o = options(o, pairs)
  % Options given as pairs of name and value over their defaults. For the functions of this package.
  for i = 1:2:numel(pairs)
    name = char(pairs{i});
    if ~isfield(o, name)
      error('dea:argument', 'no such option; there are: %s', strjoin(fieldnames(o)', ', '));
    elseif i == numel(pairs)
      error('dea:argument', 'option ''%s'' has no value', name);
    end
    o.(name) = pairs{i + 1};
  end
end
