function text = value_text(value)
  % A value as it stands in a design file: numbers, logicals, lists. For Design.set.
  if islogical(value) && isscalar(value)
    names = {'no', 'yes'};
    text = names{value + 1};
  elseif iscellstr(value)
    text = ['[' strjoin(value(:)', ', ') ']'];
  elseif isnumeric(value) && isscalar(value)
    text = sprintf('%.17g', value);
  elseif isnumeric(value)
    text = ['[' strjoin(arrayfun(@(x) sprintf('%.17g', x), value(:)', ...
                                 'UniformOutput', false), ', ') ']'];
  else
    text = char(value);
  end
end
