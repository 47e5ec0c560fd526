function [low_m, high_m] = corners(low_m, high_m)
  % A box that is open where there is no corner. For the functions of this package.
  if isempty(low_m)
    low_m = [-1e30, -1e30, -1e30];
  end
  if isempty(high_m)
    high_m = [1e30, 1e30, 1e30];
  end
end
